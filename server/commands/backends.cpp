#include "server/commands/backends.hpp"

#include <fmt/format.h>

namespace scancast {
namespace {

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
    return text;
}

}  // namespace scancast
