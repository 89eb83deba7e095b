#include "server/commands/service_reports.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "server/base/faults.hpp"
#include "server/server.hpp"

namespace scancast {
namespace {

std::string statusOf(ScancastServer& server, const DeviceStatus& device) {
    if (device.state != DeviceStatus::State::Ready) return "Opening the device";
    const auto clouds = server.catalog().list();
    const auto ready = std::ranges::count(clouds, CloudState::Ready, &CatalogEntry::state);
    return fmt::format("{}, {} of {} clouds ready, drawing with {}", server.url(), ready, clouds.size(),
                       device.info.name);
}

ServiceState stateOf(ScancastServer& server, bool stopping) {
    const DeviceStatus device = server.scheduler().device();
    return {.ready = device.state == DeviceStatus::State::Ready,
            .stopping = stopping,
            .status = stopping ? "Finishing what was promised" : statusOf(server, device),
            .silence = server.silence()};
}

/// With RELOADING=1 (sd_notify(3)): by it systemd tells the READY=1 that follows from one of before.
std::string monotonicTime(ServiceReports::Clock::time_point now) {
    const auto since = std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch());
    return fmt::format("MONOTONIC_USEC={}\n", since.count());
}

}  // namespace

bool ServiceReports::holdsBack(const ServiceState& state) const {
    return watchdog_ && state.silence > *watchdog_ / 2;
}

// A quarter of the period: one that is lost, or late on a busy machine, is followed by another in time.
bool ServiceReports::signIsDue(const ServiceState& state, Clock::time_point now) const {
    return watchdog_ && !holdsBack(state) && (!lastSign_ || now - *lastSign_ >= *watchdog_ / 4);
}

std::string ServiceReports::due(const ServiceState& state, Clock::time_point now) const {
    std::string lines;
    if (state.reloading && !told_.reloading && told_.ready) lines += "RELOADING=1\n" + monotonicTime(now);
    const bool isBack = told_.reloading && !state.reloading;
    if (state.ready && (!told_.ready || isBack)) lines += "READY=1\n";
    if (state.stopping && !told_.stopping) lines += "STOPPING=1\n";
    if (state.status != told_.status) lines += "STATUS=" + state.status + "\n";
    if (signIsDue(state, now)) lines += "WATCHDOG=1\n";
    return lines;
}

void ServiceReports::told(const ServiceState& state, Clock::time_point now) {
    if (signIsDue(state, now)) lastSign_ = now;
    told_ = state;
}

Service::Service(ServiceManager manager) : manager_(std::move(manager)), reports_(manager_.watchdog()) {}

void Service::report(ScancastServer& server, bool stopping) {
    tell([&] { return stateOf(server, stopping); });
}

void Service::reportReload(ScancastServer& server) {
    tell([&] {
        ServiceState state = stateOf(server, false);
        state.reloading = true;
        state.status = "Reading tokens, certificate and the list of clouds anew";
        return state;
    });
}

void Service::tell(const std::function<ServiceState()>& state) {
    if (!manager_.listens()) return;
    // Without memory for it nothing is told, and all of it the next time.
    std::ignore = contained("Telling the service manager", [&] { tellNews(state()); });
}

void Service::tellNews(const ServiceState& state) {
    const auto now = ServiceReports::Clock::now();
    const bool holdsBack = reports_.holdsBack(state);
    if (holdsBack && !heldBack_) {
        spdlog::error(
            "The render thread or the network has not come back for {} s: the service manager is no longer "
            "told "
            "that this server is alive, and will end it unless that changes.",
            std::chrono::duration_cast<std::chrono::seconds>(state.silence).count());
    }
    heldBack_ = holdsBack;
    const std::string lines = reports_.due(state, now);
    if (lines.empty()) return;
    const auto told = manager_.tell(lines);
    if (told) reports_.told(state, now);
    if (!told && !failed_) spdlog::warn("{}", told.error().message);
    failed_ = !told;
}

}  // namespace scancast
