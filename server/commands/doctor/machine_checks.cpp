#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

#include "files/machine.hpp"
#include "server/commands/doctor/checks.hpp"
#include "server/net/clients/open_files.hpp"
#include "server/net/tls/tls.hpp"
#include "server/scheduler/video_places.hpp"

namespace scancast {
namespace {

std::string gibibytes(std::uint64_t bytes) {
    constexpr double gib = 1 << 30;
    return fmt::format("{:.1f} GiB", double(bytes) / gib);
}

void lookAtBackends(const ServeOptions& options, Findings& findings) {
    const std::string& asked = options.device.backend;
    bool draws = false;
    for (const DeviceInfo& device : listDevices()) {
        const bool opens = !device.renderer.empty();
        const bool isMeant = (asked == "auto" || device.name == asked) &&
                             (options.device.eglDevice < 0 || device.name != "egl" ||
                              device.eglDevice == options.device.eglDevice);
        draws = draws || (opens && isMeant);
        findings.ok("draws", opens ? title(device)
                                   : fmt::format("{} does not open, which is no fault: {}", device.name,
                                                 device.version));
    }
    if (draws) return;
    findings.fault(
        "draws",
        fmt::format("--backend={}{}: there is no such device here that opens", asked,
                    options.device.eglDevice < 0 ? std::string()
                                                 : fmt::format(" --egl-device={}", options.device.eglDevice)),
        "--backend=auto takes the best there is, --backend=cpu needs no driver");
}

/// "15.6 GiB", or "8.0 of 15.6 GiB, by a control group".
std::string usableMemory(std::uint64_t usable) {
    const std::uint64_t machine = std::uint64_t(std::max(0L, ::sysconf(_SC_PHYS_PAGES))) *
                                  std::uint64_t(std::max(0L, ::sysconf(_SC_PAGESIZE)));
    if (usable >= machine) return gibibytes(usable);
    return fmt::format("{} of {}, by a control group,", gibibytes(usable), gibibytes(machine));
}

void lookAtMemory(const ServeOptions& options, Findings& findings) {
    const std::uint64_t all = machineMemory();
    const auto shares = memoryShares(options);
    if (!shares)
        return findings.fault("memory", shares.error().message,
                              "leave --memory-limit and --transient-limit out, and they fit this machine");
    const std::string text =
        fmt::format("{} may be used here; {} for clouds, {} for pictures and clients", usableMemory(all),
                    gibibytes(shares->clouds), gibibytes(shares->transient));
    if (shares->clouds + shares->transient <= all) return findings.ok("memory", text);
    findings.warning("memory", text + ": more than there is, so that the system may end the server",
                     fmt::format("--memory-limit {}M", (all / 2) >> 20));
}

void lookAtProcessors(const ServeOptions& options, Findings& findings) {
    const int cores = machineCores(), all = int(std::max(1u, std::thread::hardware_concurrency()));
    const std::string text = cores < all
                                 ? fmt::format("{} of {}, by the quota of a control group", cores, all)
                                 : fmt::format("{}", cores);
    if (options.device.threads <= cores) return findings.ok("processors", text);
    findings.warning("processors", fmt::format("{}; --threads {} is more", text, options.device.threads),
                     "leave --threads out");
}

void lookAtOpenFiles(const ServeOptions& options, Findings& findings) {
    const auto connections = maxConnections(options);
    rlimit limit{};
    getrlimit(RLIMIT_NOFILE, &limit);
    if (!connections)
        return findings.fault("open files", connections.error().message,
                              "ulimit -Hn, or LimitNOFILE= of a systemd unit");
    const std::string text = fmt::format("{} may be open; {} connections, {} of them streams", limit.rlim_max,
                                         *connections, options.server.limits.maxSessions);
    const std::size_t wished = ConnectionWish{options.server.limits.maxSessions, {}, 0}.connections();
    if (options.maxConnections > 0 || *connections >= wished) return findings.ok("open files", text);
    findings.warning("open files", fmt::format("{}, where {} are usual", text, wished),
                     "ulimit -Hn, or LimitNOFILE= of a systemd unit, allows more");
}

void lookAtVideo(const ServeOptions& options, Findings& findings) {
    const VideoPlaces video(options.server.limits.videoSessions);
    const std::string text = "moving frames: " + video.text();
    if (options.server.limits.videoSessions == 0 || video.codecs().size() > 1)
        return findings.ok("video", text);
    findings.warning("video", text + ". They are JPEG, about three times as large",
                     "install it, or --video-sessions 0 for no video");
}

// Certificates and links that expire are judged by it.
void lookAtClock(Findings& findings) {
    using Clock = std::chrono::system_clock;
    const Clock::time_point now = Clock::now();
    std::error_code error;
    const auto written = std::filesystem::last_write_time("/proc/self/exe", error);
    const std::string mend = "timedatectl set-ntp true, or set it by hand";
    if (const auto made = std::chrono::file_clock::to_sys(written);
        !error && now < made - std::chrono::hours(24))
        return findings.fault("clock",
                              fmt::format("{}, but this program was installed at {}", dateText(now),
                                          dateText(std::chrono::time_point_cast<Clock::duration>(made))),
                              mend);
    timex state{};
    if (::adjtimex(&state) == TIME_ERROR)
        return findings.warning("clock",
                                dateText(now) + "; nothing keeps it right, as far as the system knows", mend);
    findings.ok("clock", dateText(now));
}

}  // namespace

void lookAtMachine(const ServeOptions& options, Findings& findings) {
    lookAtBackends(options, findings);
    lookAtMemory(options, findings);
    lookAtProcessors(options, findings);
    lookAtOpenFiles(options, findings);
    lookAtVideo(options, findings);
    lookAtClock(findings);
}

}  // namespace scancast
