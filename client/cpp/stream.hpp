// A live session: views go to the server, frames come back. Boost.Beast stays in the .cpp.
//
// Owned and used by one thread, interrupt() excepted; every call blocks until it is done or its deadline has
// passed. After an error other than a Problem the session is over: open another. A client that neither
// receives nor sends for a long time is not there for the server's pings, and is dropped. live_stream.hpp has
// a thread of its own and comes back after the connection is lost.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "client/cpp/credentials.hpp"
#include "client/cpp/server_url.hpp"
#include "client/cpp/timeouts.hpp"
#include "protocol/frame_header.hpp"
#include "protocol/messages.hpp"
#include "protocol/view/view.hpp"

namespace scancast::client {

struct ReceivedFrame {
    FrameHeader header;
    std::vector<std::uint8_t> jpeg;           ///< of a video's frame empty
    std::vector<std::uint8_t> packedDepth{};  ///< where hello asked for depth: unpackDepth() takes it
    /// Of a frame whose codec is H264, which hello must have asked for: its access unit. FrameDecoder shows either.
    std::vector<std::uint8_t> h264{};
    std::size_t pictureBytes() const { return jpeg.size() + h264.size(); }
};

/// Whatever may come next from a server.
using StreamEvent = std::variant<ReceivedFrame, messages::Stats, messages::Picked, messages::ProblemReport,
                                 messages::Drain, messages::Pong>;

class Stream {
  public:
    /// Connects, agrees on the subprotocol, says hello and awaits the welcome. Errors: the network's;
    /// Unsupported when the other side speaks another subprotocol; what the server refuses with; Malformed
    /// for a welcome that is none. `readBytesPerSecond` plays a slow line, for measurements; 0 = unlimited.
    static Expected<Stream> open(const ServerUrl& url, const messages::Hello& hello,
                                 const Timeouts& timeouts = {}, const Credentials& credentials = {},
                                 double readBytesPerSecond = 0);

    Stream(Stream&&) noexcept;
    Stream& operator=(Stream&&) noexcept;
    ~Stream();  ///< drops the connection; close() is the polite way

    const messages::Welcome& welcome() const;

    /// Asks for a view. `seq` comes back in the frames that show it; let it grow.
    Expected<void> sendView(std::uint64_t seq, const View& view);
    Expected<void> send(const ClientMessage& message);
    /// Tells the server that this frame and all before it have arrived; it sends at most two ahead of that.
    Expected<void> ack(const FrameHeader& header);

    /// The next thing that the server sends. Messages of unknown type are skipped. Errors: the network's;
    /// Truncated, Malformed or Unsupported for frames and messages that are not what they should be;
    /// Cancelled or ResourceLimit when the server says goodbye.
    Expected<StreamEvent> receive();
    /// The same, but waits for `wait` at most, and no longer than until interrupt() is called: then nothing,
    /// and the session goes on.
    Expected<std::optional<StreamEvent>> receiveFor(std::chrono::milliseconds wait);
    /// Ends the receiveFor() that waits now, or else the next one. From any thread.
    void interrupt();
    /// The next frame; skips stats, picked points and pongs. A problem that the server reports is an error
    /// here.
    Expected<ReceivedFrame> receiveFrame();

    /// Says goodbye and waits for the server's.
    Expected<void> close();
    /// The same, but waits no longer than that, nor than for any answer.
    Expected<void> close(std::chrono::milliseconds patience);

  private:
    class Connection;
    explicit Stream(std::unique_ptr<Connection> connection);
    std::unique_ptr<Connection> connection_;
};

}  // namespace scancast::client
