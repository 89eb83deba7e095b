// Clients for tests, on plain sockets: they can say what a well-behaved library would not, and every wait of
// theirs has a deadline. Each object belongs to one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scancast::test {

inline constexpr std::chrono::seconds netPatience{20};

/// A TCP connection to this machine.
class RawSocket {
  public:
    /// `receiveBuffer` bytes are what the system keeps for a reader that is slow; 0 = as usual.
    explicit RawSocket(std::uint16_t port, int receiveBuffer = 0);
    ~RawSocket();
    RawSocket(RawSocket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    RawSocket& operator=(RawSocket&&) = delete;

    bool send(std::string_view bytes);
    /// Up to `most` bytes; empty at the end of the stream, on an error, or when the time is up.
    std::string receive(std::size_t most, std::chrono::milliseconds patience = netPatience);
    /// Everything up to the end of the stream.
    std::string receiveAll(std::chrono::milliseconds patience = netPatience);
    /// Whether the other side has closed, and everything has been read.
    bool atEnd() const;
    /// Closes with a reset, as when a machine dies.
    void abort();

  private:
    int fd_ = -1;
};

struct HttpReply {
    int status = 0;
    std::vector<std::pair<std::string, std::string>> headers;  ///< names in lower case
    std::string body;
    bool whole = true;  ///< false: it was to come in chunks, and the connection ended before the last one
    std::string header(std::string_view name) const;
};

/// One request on a connection of its own, or, with `socket`, on that one. `status` 0 = no answer.
HttpReply request(std::uint16_t port, const std::string& target, const std::vector<std::string>& headers = {},
                  const std::string& method = "GET");
HttpReply requestOn(RawSocket& socket, const std::string& target,
                    const std::vector<std::string>& headers = {}, const std::string& method = "GET");
/// With a body, on a connection of its own.
HttpReply post(std::uint16_t port, const std::string& target, const std::string& body,
               const std::vector<std::string>& headers);
/// Reads one answer; the body by its Content-Length, or in chunks: trailers are put behind the headers.
HttpReply readReply(RawSocket& socket, bool hasBody = true);

struct WsMessage {
    enum class Kind : std::uint8_t { Text = 1, Binary = 2, Close = 8, Ping = 9, Pong = 10, Gone = 255 };
    Kind kind = Kind::Gone;
    std::string payload;
    int closeCode() const;
};

/// A WebSocket client that may misbehave.
class RawWebSocket {
  public:
    /// Connects and upgrades. `protocol` empty = offers none.
    explicit RawWebSocket(std::uint16_t port, const std::string& protocol = "scancast.v1",
                          const std::vector<std::string>& headers = {});
    int status() const { return status_; }  ///< 101 when it was upgraded
    const HttpReply& reply() const { return reply_; }

    bool text(std::string_view message) { return frame(0x81, message); }
    bool binary(std::string_view message) { return frame(0x82, message); }
    /// `first` = FIN and opcode as they stand on the wire. Unmasked frames are against the rules.
    bool frame(std::uint8_t first, std::string_view payload, bool masked = true);
    /// The next message; pings are answered on the way. Gone at the end of the stream or of patience.
    WsMessage receive(std::chrono::milliseconds patience = netPatience);
    /// The next one of that kind; others are skipped. Gone when the stream ends first.
    WsMessage receiveKind(WsMessage::Kind kind, std::chrono::milliseconds patience = netPatience);
    RawSocket& socket() { return socket_; }

  private:
    bool fill(std::size_t bytes, std::chrono::steady_clock::time_point end);

    RawSocket socket_;
    HttpReply reply_;
    int status_ = 0;
    std::string buffer_;
};

}  // namespace scancast::test
