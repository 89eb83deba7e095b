#include "tests/integration/raw_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace scancast::test {
namespace {

using Clock = std::chrono::steady_clock;

int millisecondsUntil(Clock::time_point end) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    return int(std::max<long long>(0, left));
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

std::string requestText(const std::string& method, const std::string& target,
                        const std::vector<std::string>& headers) {
    std::string text = method + " " + target + " HTTP/1.1\r\n";
    bool hasHost = false;
    for (const std::string& header : headers) hasHost = hasHost || lower(header).rfind("host:", 0) == 0;
    if (!hasHost) text += "Host: localhost\r\n";
    for (const std::string& header : headers) text += header + "\r\n";
    return text + "\r\n";
}

}  // namespace

RawSocket::RawSocket(std::uint16_t port, int receiveBuffer) {
    fd_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (receiveBuffer > 0) ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receiveBuffer, sizeof receiveBuffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        ::close(fd_);
        fd_ = -1;
        return;
    }
    const timeval patience{netPatience.count(), 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
}

RawSocket::~RawSocket() {
    if (fd_ >= 0) ::close(fd_);
}

bool RawSocket::send(std::string_view bytes) {
    while (!bytes.empty()) {
        const auto sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) return false;
        bytes.remove_prefix(std::size_t(sent));
    }
    return true;
}

std::string RawSocket::receive(std::size_t most, std::chrono::milliseconds patience) {
    pollfd readable{fd_, POLLIN, 0};
    if (fd_ < 0 || ::poll(&readable, 1, int(patience.count())) <= 0) return {};
    std::string bytes(most, '\0');
    const auto count = ::recv(fd_, bytes.data(), bytes.size(), 0);
    bytes.resize(count > 0 ? std::size_t(count) : 0);
    return bytes;
}

std::string RawSocket::receiveAll(std::chrono::milliseconds patience) {
    const auto end = Clock::now() + patience;
    std::string all;
    while (true) {
        const std::string part = receive(65536, std::chrono::milliseconds(millisecondsUntil(end)));
        if (part.empty()) return all;
        all += part;
    }
}

bool RawSocket::atEnd() const {
    char next = 0;
    return ::recv(fd_, &next, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

void RawSocket::abort() {
    const linger reset{1, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
    ::close(std::exchange(fd_, -1));
}

std::string HttpReply::header(std::string_view name) const {
    for (const auto& [key, value] : headers) {
        if (key == name) return value;
    }
    return {};
}

namespace {

/// `reply.body` is what has come of it already.
void readChunks(RawSocket& socket, HttpReply& reply) {
    std::string bytes = std::exchange(reply.body, {});
    reply.whole = false;
    const auto more = [&] {
        const std::string part = socket.receive(1 << 20);
        bytes += part;
        return !part.empty();
    };
    std::size_t at = 0;
    const auto line = [&]() -> std::optional<std::string> {
        std::size_t end = std::string::npos;
        while ((end = bytes.find("\r\n", at)) == std::string::npos)
            if (!more()) return std::nullopt;
        std::string text = bytes.substr(at, end - at);
        at = end + 2;
        return text;
    };
    for (;;) {
        const auto head = line();
        if (!head) return;
        const std::size_t length = std::strtoul(head->c_str(), nullptr, 16);
        if (length == 0) break;
        while (bytes.size() < at + length + 2)
            if (!more()) {
                reply.body += bytes.substr(at, length);
                return;
            }
        reply.body.append(bytes, at, length);
        bytes.erase(0, at + length + 2);
        at = 0;
    }
    for (;;) {
        const auto trailer = line();
        if (!trailer) return;
        if (trailer->empty()) break;
        const auto colon = trailer->find(": ");
        if (colon != std::string::npos)
            reply.headers.emplace_back(lower(trailer->substr(0, colon)), trailer->substr(colon + 2));
    }
    reply.whole = true;
}

}  // namespace

HttpReply readReply(RawSocket& socket, bool hasBody) {
    std::string bytes;
    std::size_t headEnd = std::string::npos;
    while ((headEnd = bytes.find("\r\n\r\n")) == std::string::npos) {
        const std::string part = socket.receive(65536);
        if (part.empty()) return {};
        bytes += part;
    }
    HttpReply reply;
    reply.status = std::atoi(bytes.c_str() + 9);
    std::size_t at = bytes.find("\r\n") + 2;
    while (at < headEnd) {
        const std::size_t end = bytes.find("\r\n", at);
        const std::string line = bytes.substr(at, end - at);
        const auto colon = line.find(": ");
        if (colon != std::string::npos)
            reply.headers.emplace_back(lower(line.substr(0, colon)), line.substr(colon + 2));
        at = end + 2;
    }
    reply.body = bytes.substr(headEnd + 4);
    if (hasBody && reply.header("transfer-encoding") == "chunked") {
        readChunks(socket, reply);
        return reply;
    }
    const std::string length = reply.header("content-length");
    const std::size_t wanted = hasBody && !length.empty() ? std::stoul(length) : 0;
    while (reply.body.size() < wanted) {
        const std::string part = socket.receive(65536);
        if (part.empty()) return {};
        reply.body += part;
    }
    return reply;
}

HttpReply requestOn(RawSocket& socket, const std::string& target, const std::vector<std::string>& headers,
                    const std::string& method) {
    if (!socket.send(requestText(method, target, headers))) return {};
    return readReply(socket, method != "HEAD");
}

HttpReply request(std::uint16_t port, const std::string& target, const std::vector<std::string>& headers,
                  const std::string& method) {
    RawSocket socket(port);
    return requestOn(socket, target, headers, method);
}

HttpReply post(std::uint16_t port, const std::string& target, const std::string& body,
               const std::vector<std::string>& headers) {
    RawSocket socket(port);
    std::vector<std::string> all = headers;
    all.push_back("Content-Length: " + std::to_string(body.size()));
    if (!socket.send(requestText("POST", target, all) + body)) return {};
    return readReply(socket);
}

int WsMessage::closeCode() const {
    if (kind != Kind::Close || payload.size() < 2) return 0;
    return static_cast<unsigned char>(payload[0]) * 256 + static_cast<unsigned char>(payload[1]);
}

RawWebSocket::RawWebSocket(std::uint16_t port, const std::string& protocol,
                           const std::vector<std::string>& headers)
    : socket_(port) {
    // The key is the example of RFC 6455, 1.3, whose answer stands there too.
    std::vector<std::string> all{"Connection: Upgrade", "Upgrade: websocket", "Sec-WebSocket-Version: 13",
                                 "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="};
    if (!protocol.empty()) all.push_back("Sec-WebSocket-Protocol: " + protocol);
    all.insert(all.end(), headers.begin(), headers.end());
    if (!socket_.send(requestText("GET", "/api/v1/stream", all))) return;
    reply_ = readReply(socket_);
    status_ = reply_.status;
    buffer_ = status_ == 101 ? reply_.body : std::string();
    if (status_ == 101 && reply_.header("sec-websocket-accept") != "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=")
        status_ = -1;
}

bool RawWebSocket::frame(std::uint8_t first, std::string_view payload, bool masked) {
    std::string bytes(1, char(first));
    const unsigned char maskBit = masked ? 0x80 : 0;
    if (payload.size() < 126) {
        bytes.push_back(char(maskBit | payload.size()));
    } else if (payload.size() < 65536) {
        bytes.push_back(char(maskBit | 126));
        bytes.push_back(char(payload.size() >> 8));
        bytes.push_back(char(payload.size() & 255));
    } else {
        bytes.push_back(char(maskBit | 127));
        for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(char((payload.size() >> shift) & 255));
    }
    constexpr unsigned char mask[4] = {0x12, 0x34, 0x56, 0x78};
    if (masked) bytes.append(reinterpret_cast<const char*>(mask), 4);
    for (std::size_t i = 0; i < payload.size(); ++i) {
        bytes.push_back(masked ? char(static_cast<unsigned char>(payload[i]) ^ mask[i % 4]) : payload[i]);
    }
    return socket_.send(bytes);
}

bool RawWebSocket::fill(std::size_t bytes, Clock::time_point end) {
    while (buffer_.size() < bytes) {
        const std::string part = socket_.receive(65536, std::chrono::milliseconds(millisecondsUntil(end)));
        if (part.empty()) return false;
        buffer_ += part;
    }
    return true;
}

WsMessage RawWebSocket::receive(std::chrono::milliseconds patience) {
    const auto end = Clock::now() + patience;
    std::string payload;
    std::uint8_t kind = 0;
    while (true) {
        if (!fill(2, end)) return {};
        const auto first = static_cast<unsigned char>(buffer_[0]);
        std::uint64_t length = static_cast<unsigned char>(buffer_[1]) & 127;
        std::size_t head = 2;
        const int extra = length == 126 ? 2 : length == 127 ? 8 : 0;
        if (!fill(head + std::size_t(extra), end)) return {};
        if (extra > 0) length = 0;
        for (int i = 0; i < extra; ++i) length = length * 256 + static_cast<unsigned char>(buffer_[head++]);
        if (!fill(head + length, end)) return {};
        const std::string part = buffer_.substr(head, length);
        buffer_.erase(0, head + length);
        const std::uint8_t opcode = first & 15;
        if (opcode == 9) {
            frame(0x8a, part);
            continue;
        }
        if (opcode >= 8) return {WsMessage::Kind(opcode), part};
        if (opcode != 0) kind = opcode;
        payload += part;
        if ((first & 0x80) != 0) return {WsMessage::Kind(kind), payload};
    }
}

WsMessage RawWebSocket::receiveKind(WsMessage::Kind kind, std::chrono::milliseconds patience) {
    const auto end = Clock::now() + patience;
    while (true) {
        WsMessage message = receive(std::chrono::milliseconds(millisecondsUntil(end)));
        if (message.kind == kind || message.kind == WsMessage::Kind::Gone) return message;
    }
}

}  // namespace scancast::test
