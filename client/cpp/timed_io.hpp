// One asynchronous operation after the other, each with a deadline: Beast's blocking calls have none.
//
// Included by the .cpp files of this room only, because it pulls in Boost.Asio.
#pragma once

#include <utility>  // first: Asio 1.74 forgets it under C++20

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <optional>

#include "client/cpp/credentials.hpp"
#include "client/cpp/server_url.hpp"
#include "client/cpp/timeouts.hpp"
#include "transport/net_stream.hpp"

namespace scancast::client {

using ErrorCodeOfBoost = boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// Starts an operation by calling `start(handler)`, then runs it to its end or to the deadline, at which
/// `cancel()` must make it end. timed_out stands for the deadline.
template <class Start, class Cancel>
ErrorCodeOfBoost runUntil(boost::asio::io_context& io, Clock::time_point deadline, Start start,
                          Cancel cancel) {
    std::optional<ErrorCodeOfBoost> result;
    io.restart();
    start([&result](ErrorCodeOfBoost error, auto&&...) { result = error; });
    while (!result && io.run_one_until(deadline) > 0) {
    }
    if (result) return *result;
    cancel();
    // The handler refers to this stack frame, so it has to run before we return.
    while (!result && io.run_one() > 0) {
    }
    return boost::asio::error::timed_out;
}

/// Resolves, connects, and, for https, agrees on TLS with a server whose certificate is for this host and
/// signed by whom the credentials trust. Unsupported when it is not.
Expected<NetStream> connectUntil(boost::asio::io_context& io, const ServerUrl& url,
                                 const Credentials& credentials, Clock::time_point deadline);

/// What an error of the network means, in words. `doing` continues "… while": "sending a view".
Error networkError(const ErrorCodeOfBoost& error, const ServerUrl& url, std::string_view doing);

}  // namespace scancast::client
