// An HTTP request and its answer as plain values: what the routes work with, so that they know nothing of
// sockets and only http_session.cpp and the like include Beast.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/problem.hpp"
#include "server/net/api/body_source.hpp"
#include "server/net/log/request_ids.hpp"

namespace scancast {

struct HttpRequest {
    std::string method;  ///< "GET"
    std::string target;  ///< path and query as sent
    std::vector<std::pair<std::string, std::string>>
        headers;  ///< names in lower case, in the order of arrival
    std::string body{};
    std::string client{};  ///< whom its work is counted for: the address that it came from
    RequestIds ids{};
    /// Where this server is for whoever asks, without a slash at its end: "https://scans.example.org" (public_url.hpp).
    std::string base{};

    /// All values of that name (lower case), joined by ", "; empty when there is none.
    std::string header(std::string_view name) const;
    std::size_t count(std::string_view name) const;
};

/// ASCII letters alone, as HTTP compares names.
std::string lowerCase(std::string_view text);

/// Why nobody can tell where the body of this request ends, as a sentence; empty when one can (RFC
/// 9112, 6.3). A sender and a proxy between that understood such a request differently would let one request
/// hide in another.
std::string framingFault(const HttpRequest& request, unsigned version);

struct HttpResponse {
    int status = 200;
    std::vector<std::pair<std::string, std::string>> headers;
    std::string text;                                        ///< the body, unless `bytes` or `photo` is set
    std::shared_ptr<const std::vector<std::uint8_t>> bytes;  ///< a picture, shared
    std::shared_ptr<const std::vector<std::byte>> photo{};   ///< the same of what a scan brought along
    std::shared_ptr<BodySource> source{};                    ///< the body, made while it is sent: chunked
    std::optional<Problem> problem{};                        ///< that `text` is
    std::optional<double> price{};  ///< of the picture that was drawn for it, in seconds of a core
    bool bodyUnknown = false;       ///< answer to HEAD whose length nobody has worked out: no Content-Length
    std::optional<std::uint64_t> bodyBytes{};  ///< answer to HEAD: how long a body would be that is not here

    std::string_view body() const;
    HttpResponse& set(std::string name, std::string value);
    /// Says by which id the log knows the request: X-Request-Id and, of a problem, in it.
    HttpResponse& identify(const RequestIds& ids);
    /// nullptr when there is none of that name (as written).
    const std::string* find(std::string_view name) const;
};

/// Called once; from any thread.
using Respond = std::function<void(HttpResponse)>;

HttpResponse problemResponse(const Problem& problem);
HttpResponse jsonResponse(const nlohmann::json& body);
HttpResponse textResponse(int status, std::string text);

}  // namespace scancast
