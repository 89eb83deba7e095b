// The GL backends as test parameters: opened once per test program, skipped loudly where the library is
// missing.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>

#include "renderer/device/device.hpp"

namespace scancast::test {

/// nullptr where it does not open; `reason` then says why. Devices live until the program ends, since
/// compiling their shaders takes longer than the tests do.
inline Device* sharedDevice(const std::string& backend, std::string& reason) {
    static std::map<std::string, Expected<std::unique_ptr<Device>>> devices;
    auto found = devices.find(backend);
    if (found == devices.end()) {
        DeviceOptions options;
        options.backend = backend;
        found = devices.emplace(backend, createDevice(options)).first;
    }
    if (found->second) return found->second->get();
    reason = found->second.error().message;
    return nullptr;
}

inline Drawing drawingOf(const Viewpoint& viewpoint, const Cut& cut, std::span<const Pass> passes) {
    static constexpr glm::dvec2 noJitter[1] = {{0, 0}};
    Drawing d;
    d.viewpoint = &viewpoint;
    d.cut = &cut;
    d.passes = passes;
    d.window = {0, 0, viewpoint.width, viewpoint.height};
    d.jitter = noJitter;
    return d;
}

}  // namespace scancast::test

/// Declares `Device* NAME`, or skips the test saying what is missing.
#define REQUIRE_DEVICE(NAME, BACKEND)                                                       \
    std::string NAME##Reason;                                                               \
    ::scancast::Device* const NAME = ::scancast::test::sharedDevice(BACKEND, NAME##Reason); \
    if (!NAME) GTEST_SKIP() << "MISSING BACKEND " << (BACKEND) << ": " << NAME##Reason
