#include "server/terminal/service_manager.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "files/system_error.hpp"

namespace scancast {
namespace {

std::string taken(const char* variable) {
    const char* const value = std::getenv(variable);
    std::string text = value == nullptr ? "" : value;
    ::unsetenv(variable);
    return text;
}

Expected<std::string> socketAddress(std::string name) {
    constexpr std::size_t longest = sizeof(sockaddr_un::sun_path) - 1;
    if (name.size() < 2 || name.size() > longest || (name.front() != '/' && name.front() != '@')) {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("NOTIFY_SOCKET=\"{}\": this is neither an absolute path nor an abstract name "
                                "(\"@…\") of at most {} bytes; unset it to run without a service manager.",
                                name, longest),
                    "NOTIFY_SOCKET");
    }
    if (name.front() == '@') name.front() = '\0';
    return name;
}

template <class Number>
std::optional<Number> positive(const std::string& text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || number <= 0) return std::nullopt;
    return number;
}

// Another process's watchdog - $WATCHDOG_PID tells - is not ours.
Expected<std::optional<std::chrono::microseconds>> watchdogTime(const std::string& time,
                                                                const std::string& process) {
    if (time.empty() || (!process.empty() && positive<pid_t>(process) != ::getpid())) return std::nullopt;
    const auto number = positive<std::int64_t>(time);
    if (!number) {
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format(
                "WATCHDOG_USEC=\"{}\": this is no number of microseconds above 0; unset it to run without "
                "a watchdog.",
                time),
            "WATCHDOG_USEC");
    }
    return std::chrono::microseconds(*number);
}

}  // namespace

Expected<ServiceManager> ServiceManager::fromEnvironment() {
    const std::string name = taken("NOTIFY_SOCKET"), time = taken("WATCHDOG_USEC");
    const std::string process = taken("WATCHDOG_PID");
    ServiceManager manager;
    if (name.empty()) return manager;
    auto address = socketAddress(name);
    if (!address) return passOn(std::move(address));
    manager.address_ = std::move(*address);
    auto watchdog = watchdogTime(time, process);
    if (!watchdog) return passOn(std::move(watchdog));
    manager.watchdog_ = *watchdog;
    manager.socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (!manager.listens()) {
        return fail(ErrorCode::Io, "a socket to the service manager (NOTIFY_SOCKET) cannot be opened: " +
                                       systemReason(errno));
    }
    return manager;
}

ServiceManager::~ServiceManager() {
    if (listens()) ::close(socket_);
}

ServiceManager::ServiceManager(ServiceManager&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      address_(std::move(other.address_)),
      watchdog_(other.watchdog_) {}

ServiceManager& ServiceManager::operator=(ServiceManager&& other) noexcept {
    std::swap(socket_, other.socket_);
    std::swap(address_, other.address_);
    std::swap(watchdog_, other.watchdog_);
    return *this;
}

Expected<void> ServiceManager::tell(std::string_view lines) const {
    if (!listens()) return {};
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, address_.data(), address_.size());
    const auto length = socklen_t(offsetof(sockaddr_un, sun_path) + address_.size());
    // A datagram goes as a whole or not at all.
    const auto sent = ::sendto(socket_, lines.data(), lines.size(), MSG_NOSIGNAL,
                               reinterpret_cast<const sockaddr*>(&address), length);
    if (sent >= 0) return {};
    return fail(ErrorCode::Io,
                "the service manager (NOTIFY_SOCKET) could not be told: " + systemReason(errno));
}

}  // namespace scancast
