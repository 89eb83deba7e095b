// The GL backends as test parameters: opened once per test program, skipped loudly where the library is
// missing.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>

#include "renderer/device/device.hpp"

namespace scancast::test {

/// Devices live as long as the test program, since compiling their shaders takes longer than the tests do;
/// but not until static destructors run: drivers have cleaned up by then.
class SharedDevices : public testing::Environment {
  public:
    void TearDown() override { devices_.clear(); }

    /// nullptr where it does not open; `reason` then says why.
    Device* get(const std::string& backend, std::string& reason) {
        auto found = devices_.find(backend);
        if (found == devices_.end()) {
            DeviceOptions options;
            options.backend = backend;
            found = devices_.emplace(backend, createDevice(options)).first;
        }
        if (found->second) return found->second->get();
        reason = found->second.error().message;
        return nullptr;
    }

  private:
    std::map<std::string, Expected<std::unique_ptr<Device>>> devices_;
};
/// Owned by GoogleTest.
inline SharedDevices* const sharedDevices = [] {
    auto* const devices = new SharedDevices;
    testing::AddGlobalTestEnvironment(devices);
    return devices;
}();

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
#define REQUIRE_DEVICE(NAME, BACKEND)                                                             \
    std::string NAME##Reason;                                                                     \
    ::scancast::Device* const NAME = ::scancast::test::sharedDevices->get(BACKEND, NAME##Reason); \
    if (!NAME) GTEST_SKIP() << "MISSING BACKEND " << (BACKEND) << ": " << NAME##Reason
