// A service manager's socket: what sd_notify(3) calls $NOTIFY_SOCKET, as a path or as an abstract name.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>

namespace scancast::test {

class NotifySocket {
  public:
    /// Binds it; an abstract name begins with "@".
    explicit NotifySocket(std::string name) : name_(std::move(name)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, name_.data(), name_.size());
        if (name_.front() == '@') address.sun_path[0] = '\0';
        const auto length = socklen_t(offsetof(sockaddr_un, sun_path) + name_.size());
        EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), length), 0)
            << name_ << ": " << std::strerror(errno);
    }
    ~NotifySocket() { ::close(socket_); }
    NotifySocket(const NotifySocket&) = delete;
    NotifySocket& operator=(const NotifySocket&) = delete;

    const std::string& name() const { return name_; }
    /// The next datagram; nullopt when none comes in time.
    std::optional<std::string> next(std::chrono::milliseconds patience = std::chrono::seconds(60)) const {
        pollfd readable{socket_, POLLIN, 0};
        if (::poll(&readable, 1, int(patience.count())) <= 0) return std::nullopt;
        char bytes[4096];
        const auto got = ::recv(socket_, bytes, sizeof bytes, 0);
        if (got < 0) return std::nullopt;
        return std::string(bytes, std::size_t(got));
    }
    /// What has come so far.
    std::string all() const {
        std::string text;
        while (const auto one = next(std::chrono::milliseconds(0))) text += *one;
        return text;
    }
    /// Everything up to a datagram with that line; nullopt when it does not come.
    std::optional<std::string> until(const std::string& line) const {
        std::string text;
        while (const auto one = next()) {
            text += *one;
            if (one->find(line) != std::string::npos) return text;
        }
        return std::nullopt;
    }

  private:
    const std::string name_;
    const int socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

}  // namespace scancast::test
