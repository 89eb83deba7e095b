// Whether a client reads what is written to it. Time alone says little: a large picture takes long on a slow line, and
// who reads a byte now and then could keep its memory for hours. So it is asked, window by window, how much has
// arrived; the answer is the system's (transport/bytes_taken.hpp), and knows nothing of TLS or WebSocket.
//
// Owned by a connection; on its strand. Place: http, stream and mjpeg connections → **write watch** → socket.
#pragma once

#include <utility>  // before Asio: Boost 1.74 forgets it

#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

namespace scancast {

/// What a client must take of what waits for it, or it is too slow.
struct ReadRate {
    std::uint64_t bytesPerSecond = 16 * 1024;
    std::chrono::milliseconds window{
        10000};  ///< in every one; what is taken within the first is never too slow
};

class WriteWatch {
  public:
    WriteWatch(const boost::asio::steady_timer::executor_type& strand, const ReadRate& rate)
        : timer_(strand), rate_(rate) {}

    /// Something is being written. `tooSlow` is called at most once, unless end() is called before or `owner` has
    /// ended. False, and nothing is watched, where the system does not tell.
    bool begin(int socket, std::weak_ptr<void> owner, std::function<void()> tooSlow);
    /// It has been written.
    void end();

  private:
    void wait();
    void look();

    boost::asio::steady_timer timer_;
    const ReadRate rate_;
    int socket_ = -1;
    std::uint64_t number_ = 0;  ///< of what is being written
    std::uint64_t taken_ = 0;   ///< when the window began
    std::weak_ptr<void> owner_;
    std::function<void()> tooSlow_;
};

}  // namespace scancast
