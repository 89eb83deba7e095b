// What `serve` tells the service manager that started it, and when: a pure function of what holds, what has been
// told, and the time. Ready, when the server listens and its device is open, and again after each reload; a line for people when that has
// changed; a sign of life several times in each period of the watchdog - but only while the threads that matter
// come back from their work, since a process that merely runs proves nothing.
//
// Owned by the command, on the main thread; place: server → **service reports** → terminal/service_manager.hpp.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "server/terminal/service_manager.hpp"

namespace scancast {

class ScancastServer;

/// A server, as its service manager sees it.
struct ServiceState {
    bool ready = false;      ///< it listens, and its device is open
    bool stopping = false;   ///< it was told to end
    bool reloading = false;  ///< it reads its files anew
    std::string status;      ///< one line for people
    std::chrono::milliseconds
        silence{};  ///< for which a thread has not come back (ScancastServer::silence())
};

class ServiceReports {
  public:
    using Clock = std::chrono::steady_clock;

    /// `watchdog` as ServiceManager::watchdog().
    explicit ServiceReports(std::optional<std::chrono::microseconds> watchdog) : watchdog_(watchdog) {}

    /// What is to be told now; empty = nothing.
    std::string due(const ServiceState& state, Clock::time_point now) const;
    /// It was, and arrived; else it is due again.
    void told(const ServiceState& state, Clock::time_point now);
    /// Half a watchdog's period without a thread's coming back: signs of life are kept back, and the service manager
    /// will end the process when its own period is over.
    bool holdsBack(const ServiceState& state) const;

  private:
    bool signIsDue(const ServiceState& state, Clock::time_point now) const;

    std::optional<std::chrono::microseconds> watchdog_;
    ServiceState told_;
    std::optional<Clock::time_point> lastSign_;
};

/// A server's service manager, told what is new about it; the log says when it cannot be.
class Service {
  public:
    explicit Service(ServiceManager manager);
    /// To be called again and again, several times in each period of the watchdog.
    void report(ScancastServer& server, bool stopping);
    /// Files are read anew from now on, until the next report().
    void reportReload(ScancastServer& server);

  private:
    void tell(const std::function<ServiceState()>& state);
    void tellNews(const ServiceState& state);

    ServiceManager manager_;
    ServiceReports reports_;
    bool heldBack_ = false, failed_ = false;
};

}  // namespace scancast
