// A connection that is read no faster than a slow line would bring it: what has not been read waits at the
// other side, as it would before a modem. A stream for Beast, above NetStream.
//
// Included by the .cpp files of this room only. Owned by one connection, one thread.
#pragma once

#include "client/cpp/timed_io.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/buffers_prefix.hpp>

namespace scancast::client {

class PacedStream {
  public:
    using ErrorCode = NetStream::ErrorCode;
    using executor_type = NetStream::executor_type;

    /// `bytesPerSecond` 0 = as fast as they come.
    PacedStream(NetStream stream, double bytesPerSecond)
        : stream_(std::move(stream)), bytesPerSecond_(bytesPerSecond), timer_(stream_.get_executor()) {
        if (bytesPerSecond_ <= 0) return;
        // A larger buffer only hides the slow line for a while. In a smaller one a packet of the loopback's
        // does not fit: it is dropped, and sent again after a long while.
        ErrorCode ignored;
        stream_.tcp().socket().set_option(boost::asio::socket_base::receive_buffer_size(65536), ignored);
    }

    NetStream& net() { return stream_; }
    executor_type get_executor() { return stream_.get_executor(); }

    template <class Buffers, class Handler>
    void async_read_some(const Buffers& buffers, Handler&& handler) {
        if (bytesPerSecond_ <= 0) return stream_.async_read_some(buffers, std::forward<Handler>(handler));
        const auto piece = std::max<std::size_t>(1, static_cast<std::size_t>(bytesPerSecond_ / 20));
        stream_.async_read_some(
            boost::beast::buffers_prefix(piece, buffers),
            [this, handler = std::forward<Handler>(handler)](ErrorCode error, std::size_t bytes) mutable {
                timer_.expires_after(std::chrono::microseconds(
                    static_cast<std::int64_t>(static_cast<double>(bytes) / bytesPerSecond_ * 1e6)));
                timer_.async_wait([handler = std::move(handler), error, bytes](ErrorCode) mutable {
                    handler(error, bytes);
                });
            });
    }
    template <class Buffers, class Handler>
    void async_write_some(const Buffers& buffers, Handler&& handler) {
        stream_.async_write_some(buffers, std::forward<Handler>(handler));
    }

    // What Beast's WebSocket asks of a stream that it does not know.
    friend void beast_close_socket(PacedStream& stream) { beast_close_socket(stream.stream_); }
    friend void teardown(boost::beast::role_type role, PacedStream& stream, ErrorCode& error) {
        teardown(role, stream.stream_, error);
    }
    template <class Handler>
    friend void async_teardown(boost::beast::role_type role, PacedStream& stream, Handler&& handler) {
        async_teardown(role, stream.stream_, std::forward<Handler>(handler));
    }

  private:
    NetStream stream_;
    double bytesPerSecond_;
    boost::asio::steady_timer timer_;
};

}  // namespace scancast::client
