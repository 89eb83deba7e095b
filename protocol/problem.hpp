// Errors as the web expects them: RFC 9457 problem details, for HTTP answers and for the `problem` message.
//
// Plain values and pure functions; any thread.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

inline constexpr std::string_view problemMediaType = "application/problem+json";

struct Problem {
    struct Cause {
        std::string parameter;  ///< the query word or JSON path at fault: "camera.fov"
        std::string detail;
        bool operator==(const Cause&) const = default;
    };
    std::string type = "about:blank";  ///< "urn:scancast:problem:invalid-argument" for errors of ours
    std::string title;                 ///< the same for every problem of this type
    int status = 500;
    std::string detail;    ///< the sentence to read
    std::string instance;  ///< what was asked for: "/api/v1/clouds/town/snapshot.jpg"; may be empty
    std::vector<Cause> errors;
    /// Of what costs too much.
    struct Cost {
        double price = 0, limit = 0;  ///< ms of a reference core
        std::map<std::string, double>
            nearest;  ///< words of the view to change, for what would be drawn; may be empty
        bool operator==(const Cost&) const = default;
    };
    std::optional<Cost> cost{};
    /// By which the server's log knows the request (X-Request-Id); may be empty.
    std::string requestId{};
    bool operator==(const Problem&) const = default;
};

/// The HTTP status of an error that is about a request: 400, 404, 413, 422, 500, 503, 504.
int httpStatus(ErrorCode code);
/// "Not Found"; "Unknown" for what is no status.
std::string_view reasonPhrase(int status);

Problem problemOf(const Error& error, std::string instance = {});
/// For what HTTP itself refuses (401, 403, 405, 406, 415 …): type about:blank, title the reason phrase.
Problem problemOf(int status, std::string detail, std::string instance = {});

/// For clients: the error that a server meant, by the problem's type, else by its status; its message ends with the request's id, if there is one.
/// Servers are not trusted: it is plain text (text/plain_text.hpp).
Error errorOf(const Problem& problem);

nlohmann::json toJson(const Problem& problem);
/// Lenient, for clients: unknown members are skipped, missing ones keep their defaults. Malformed when it is
/// no object.
Expected<Problem> problemFromJson(const nlohmann::json& value);

}  // namespace scancast
