// The devices that tests draw with: `cpu`, `egl` and `osmesa`, opened once per test program and kept. An
// oracle is written once and asked of each of them; where a backend does not open, its tests are skipped,
// loudly.
//
// GL devices run on whatever driver there is. On a software driver they are slow, so an oracle may draw fewer
// or smaller pictures there; what it asks of each stays the same.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

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
            options.threads = 2;
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

}  // namespace scancast::test

/// Declares `Device* NAME`, or skips the test saying what is missing.
#define REQUIRE_DEVICE(NAME, BACKEND)                                                             \
    std::string NAME##Reason;                                                                     \
    ::scancast::Device* const NAME = ::scancast::test::sharedDevices->get(BACKEND, NAME##Reason); \
    if (!NAME) GTEST_SKIP() << "MISSING BACKEND " << (BACKEND) << ": " << NAME##Reason

namespace scancast::test {

/// What every device must pass, drawn with `device_`. Further parameters, if any, follow the device's name.
template <class Parameter>
class OnDeviceWith : public testing::TestWithParam<Parameter> {
  protected:
    void SetUp() override {
        REQUIRE_DEVICE(device, backend(this->GetParam()));
        device_ = device;
        const DeviceInfo info = device->info();
        slow_ = info.name != "cpu" && !info.hardware;
    }
    Device* device_ = nullptr;
    bool slow_ = false;  ///< a software driver: draw less

  private:
    static const std::string& backend(const std::string& name) { return name; }
    template <class Tuple>
    static const std::string& backend(const Tuple& parameters) {
        return std::get<0>(parameters);
    }
};
using OnDevice = OnDeviceWith<std::string>;

/// The name of a test's instance: "egl".
inline const auto deviceName = [](const testing::TestParamInfo<std::string>& p) { return p.param; };

}  // namespace scancast::test

/// Instances of a suite over OnDevice: on the cpu device, and on the GL devices that are named. Without a
/// graphics card EGL and OSMesa run the same driver, so every suite is asked of EGL. OSMesa proves what differs
/// there: its context, reading back, and a picture in every method (tests/unit/gl/context_test.cpp,
/// tests/oracle/gl/picture_test.cpp and render_agreement_test.cpp, tests/integration/backends_test.cpp).
/// The prefixes, Cpu and Gl, are what tests/CMakeLists.txt labels tests by.
#define SCANCAST_ON_DEVICES(SUITE, ...)                                                           \
    INSTANTIATE_TEST_SUITE_P(Cpu, SUITE, ::testing::Values("cpu"), ::scancast::test::deviceName); \
    INSTANTIATE_TEST_SUITE_P(Gl, SUITE, ::testing::Values(__VA_ARGS__), ::scancast::test::deviceName)
