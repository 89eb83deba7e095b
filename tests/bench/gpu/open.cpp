#include "tests/bench/gpu/open.hpp"

#include <cstdio>
#include <cstdlib>

namespace scancast::bench {
namespace {

void listOnStandardError() {
    std::fprintf(stderr, "What could draw here, best first:\n");
    for (const DeviceInfo& found : listDevices())
        std::fprintf(stderr, "  %s, %s: %s %s, %s\n", found.name.c_str(),
                     found.hardware ? "hardware" : "no hardware", found.vendor.c_str(),
                     found.renderer.c_str(), found.version.c_str());
}

}  // namespace

std::unique_ptr<Device> openOrExit(const DeviceOptions& options, bool requireHardware) {
    auto opened = createDevice(options);
    if (!opened) {
        std::fprintf(stderr, "%s\n", opened.error().message.c_str());
        std::exit(noDevice);
    }
    const DeviceInfo info = (*opened)->info();
    if (requireHardware && !info.hardware) {
        std::fprintf(stderr,
                     "%s opened %s %s, which is no graphics card: what it would measure is this machine's "
                     "processor. Without --require-hardware it is measured all the same.\n",
                     info.name.c_str(), info.vendor.c_str(), info.renderer.c_str());
        listOnStandardError();
        std::exit(noHardware);
    }
    return std::move(*opened);
}

void printDevice(const DeviceInfo& info) {
    const auto orUnknown = [](const std::string& text) { return text.empty() ? "not told" : text.c_str(); };
    std::printf("- backend: %s, %s\n", info.name.c_str(),
                info.hardware ? "hardware" : "**software: no figures of a graphics card**");
    std::printf("- vendor: %s\n- renderer: %s\n- driver: %s\n", orUnknown(info.vendor),
                orUnknown(info.renderer), orUnknown(info.version));
    if (info.memory > 0)
        std::printf("- memory: %.1f GB\n", double(info.memory) / 1e9);
    else
        std::printf("- memory: not told\n");
    std::printf("- 64-bit atomics: %s\n- rounds exactly: %s\n- tells resets: %s\n- node: %s\n",
                info.atomics64 ? "yes" : "no", info.exact ? "yes" : "no", info.tellsLoss ? "yes" : "no",
                orUnknown(info.node));
}

}  // namespace scancast::bench
