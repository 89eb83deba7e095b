// What started this process and waits to hear how it is doing - systemd, with Type=notify, or whoever speaks its
// protocol (sd_notify(3)): datagrams of lines NAME=VALUE to the socket that $NOTIFY_SOCKET names, a path or, with
// "@", an abstract name. Our own few lines, so that the program needs no library of systemd's.
//
// Owned by the command that serves, on the main thread. What is told, and when: commands/service_reports.hpp.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

class ServiceManager {
  public:
    /// As the environment names it: $NOTIFY_SOCKET, $WATCHDOG_USEC, $WATCHDOG_PID. They are taken out of it, so that
    /// importers do not speak for this process; therefore to be called once, before there are threads. Without
    /// $NOTIFY_SOCKET there is nobody to tell. InvalidArgument: an address that is none, a time that is none.
    static Expected<ServiceManager> fromEnvironment();

    ServiceManager() = default;
    ~ServiceManager();
    ServiceManager(ServiceManager&& other) noexcept;
    ServiceManager& operator=(ServiceManager&& other) noexcept;

    /// Somebody listens.
    bool listens() const { return socket_ >= 0; }
    /// The longest time that it waits for WATCHDOG=1 before it ends this process; nullopt = for ever.
    std::optional<std::chrono::microseconds> watchdog() const { return watchdog_; }
    /// Lines as "READY=1\nSTATUS=…". Never waits. Io when they did not arrive: who cares tells them again.
    Expected<void> tell(std::string_view lines) const;

  private:
    int socket_ = -1;
    std::string address_;  // as it is in sockaddr_un: an abstract one begins with a zero byte
    std::optional<std::chrono::microseconds> watchdog_;
};

}  // namespace scancast
