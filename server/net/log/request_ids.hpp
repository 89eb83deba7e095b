// By which names a request is known elsewhere: its own id, and the trace that it is a step of.
//
// Pure functions of header values, outside bytes, apart from the random numbers of what is made new; any thread.
// Pipeline: http connection → **ids** → request log, answer.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scancast {

/// Whether this may be a request's id: 1 to 64 letters, digits, dots, hyphens and underscores. What else a client
/// sends could forge a line, or a header.
bool isRequestId(std::string_view text);

/// What `traceparent` says (W3C, "Trace Context", Recommendation of 2021-11-23, section 3.2).
struct TraceParent {
    std::string trace;   ///< 32 hexadecimal digits, not all of them 0
    std::string parent;  ///< 16: the step that this one is part of
    bool sampled = false;
    bool operator==(const TraceParent&) const = default;
};
/// nullopt for what is malformed, and of version ff, which is forbidden; of versions to come what this one says, as
/// section 3.2.4 wants it.
std::optional<TraceParent> parseTraceParent(std::string_view text);

struct RequestIds {
    std::string request;               ///< X-Request-Id: the client's, or a new one
    std::optional<TraceParent> trace;  ///< nullopt = the request belongs to none
    std::string span;                  ///< this server's step of the trace, 16 digits; empty without one

    /// Of the values of both headers; one that came twice is joined by a comma, and so is malformed. What is malformed
    /// is as good as missing: ids are never a reason to refuse. Throws where there are no random numbers.
    static RequestIds of(std::string_view requestId, std::string_view traceParent);
};

}  // namespace scancast
