// One HTTP request: connect, ask, read the answer, close. Boost.Beast stays in the .cpp.
//
// Free functions that block their thread until the answer, an error, or the deadline.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/cpp/credentials.hpp"
#include "client/cpp/server_url.hpp"
#include "client/cpp/timeouts.hpp"

namespace scancast::client {

struct HttpAnswer {
    int status = 0;
    std::string contentType, etag, serverTiming, damaged;
    std::vector<std::uint8_t> body;
    std::string method{}, methodReason{};
};

/// `target` is the path with its query; `accept` may be empty, and so may `ifNoneMatch` (an ETag with its
/// quotes). Answers with a status of 400 or above become errors: the problem that their body describes, else
/// the status. Errors besides: Io (refused, closed), NotFound (host), DeadlineExceeded, Malformed (no HTTP),
/// Unsupported (TLS that is not trusted), ResourceLimit (a body of more than `longest` bytes, or of more than
/// longestRefusal with a status of 400 or above; a head of more than 8 KiB).
Expected<HttpAnswer> httpGet(const ServerUrl& url, const std::string& target, std::uint64_t longest,
                             const std::string& ifNoneMatch, const Credentials& credentials,
                             const Timeouts& timeouts);

/// The same, with a body.
Expected<HttpAnswer> httpPostJson(const ServerUrl& url, const std::string& target, std::uint64_t longest,
                                  std::string json, const Credentials& credentials, const Timeouts& timeouts);

inline constexpr std::uint64_t longestRefusal = std::uint64_t{256} << 10u;

}  // namespace scancast::client
