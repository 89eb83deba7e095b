#include "server/commands/backends.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scancast {
namespace {

// The program cannot know what others have tried; this is what we have.
constexpr const char* aboutHardware =
    "hardware: tried on one GPU so far, an NVIDIA H100 (driver 580). Others are expected to work; if one "
    "does not,\n"
    "    --backend=cpu draws the same pictures (docs/backends.md).\n";

/// "egl --egl-device=1"
std::string wayToAsk(const DeviceInfo& device) {
    std::string way = "--backend=" + device.name;
    if (device.eglDevice >= 0) way += fmt::format(" --egl-device={}", device.eglDevice);
    return way;
}

std::string memoryText(const DeviceInfo& device) {
    constexpr double gib = 1 << 30;
    if (device.memory == 0) return "memory unknown";
    return fmt::format("{:.1f} GiB of memory", static_cast<double>(device.memory) / gib);
}

std::string details(const DeviceInfo& device) {
    std::string text = device.vendor + ", " + device.version;
    if (device.name != "cpu") {
        text += device.hardware ? ", hardware, " : ", software, ";
        text += memoryText(device);
        text += device.atomics64 ? ", 64-bit atomics" : ", no 64-bit atomics";
        text += device.exact ? ", rounds exactly" : ", rounds approximately";
        if (device.hardware) text += device.tellsLoss ? ", tells resets" : ", does not tell resets";
    }
    return device.node.empty() ? text : text + ", " + device.node;
}

}  // namespace

std::string backendsText(std::span<const DeviceInfo> devices) {
    std::string text;
    for (const DeviceInfo& device : devices) {
        const bool opens = !device.renderer.empty();
        text += fmt::format("{:<32}{}\n    {}\n", wayToAsk(device), opens ? device.renderer : "does not open",
                            opens ? details(device) : device.version);
    }
    const auto drawsOnGpu = [](const DeviceInfo& device) {
        return device.hardware && !device.renderer.empty();
    };
    if (std::any_of(devices.begin(), devices.end(), drawsOnGpu)) text += aboutHardware;
    return text;
}

}  // namespace scancast
