// What the log says of one request, from its head to its last byte; and of a stream, which is a request that takes
// long, at both ends.
//
// Plain values; a record belongs to the connection that answers the request, and goes with it when another one takes
// the request over. Pipeline: http, stream, mjpeg connections → **record** → request log.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "server/net/log/request_ids.hpp"

namespace scancast {

struct RequestRecord {
    using Clock = std::chrono::steady_clock;

    enum class Event : std::uint8_t { Request, StreamOpened, StreamEnded };

    Event event = Event::Request;
    std::string client;          ///< whom it is counted for; behind trusted proxies their client
    std::string method, target;  ///< as shownTarget() has it; both empty where there was no request to read
    std::string_view route = "refused";  ///< a pattern, of a static table
    RequestIds ids;
    Clock::time_point begun = Clock::now();
    int status = 0;
    std::uint64_t bytes = 0;      ///< that were sent: of an answer all, of a stream its frames and messages
    std::optional<double> price;  ///< of the picture, in seconds of a core
    std::string token;            ///< by whose name he was let in; empty = none
    std::string session;          ///< of a stream, as shownSession() has it
    std::uint64_t frames = 0;     ///< of a stream that has ended
    std::string note;             ///< why it ended otherwise than asked for

    /// "GET /api/v1/clouds 200, 512 bytes in 1.2 ms, for 192.0.2.7, request 3f…".
    std::string sentence(Clock::time_point now) const;
    nlohmann::json fields(Clock::time_point now) const;
};

/// As nginx has it, and nobody else: the client left before he was answered.
inline constexpr int statusClientLeft = 499;

}  // namespace scancast
