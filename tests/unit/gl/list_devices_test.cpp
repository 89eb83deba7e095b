#include <gmock/gmock.h>

#include "renderer/device/device.hpp"

namespace scancast {
namespace {

using testing::HasSubstr;

TEST(ListDevices, TellsOfEveryBackendWhetherItOpensOrWhyNot) {
    const std::vector<DeviceInfo> infos = listDevices();
    int cpu = 0, egl = 0, osmesa = 0;
    for (const DeviceInfo& info : infos) {
        cpu += info.name == "cpu";
        egl += info.name == "egl";
        osmesa += info.name == "osmesa";
        EXPECT_FALSE(info.version.empty()) << info.name << " says neither version nor reason";
        EXPECT_TRUE(info.name == "egl" || (!info.hardware && info.eglDevice < 0)) << info.name;
    }
    EXPECT_EQ(cpu, 1);
    EXPECT_GE(egl, 1);
    EXPECT_EQ(osmesa, 1);
    EXPECT_TRUE(infos.front().hardware || infos.front().name == "cpu") << "best first";
}

/// What the list says opens does open, under the name and index that it says.
TEST(ListDevices, WhatIsListedOpens) {
    for (const DeviceInfo& info : listDevices()) {
        DeviceOptions options;
        options.backend = info.name;
        options.eglDevice = info.eglDevice;
        const auto device = createDevice(options);
        EXPECT_EQ(device.has_value(), !info.renderer.empty()) << info.name;
        if (device) {
            EXPECT_EQ((*device)->info().renderer, info.renderer);
            EXPECT_FALSE((*device)->info().identity.empty());
        }
    }
}

TEST(CreateDevice, AutoIsAGpuElseTheProcessor) {
    const auto device = createDevice({});
    ASSERT_TRUE(device) << device.error().message;
    const DeviceInfo info = (*device)->info();
    EXPECT_TRUE(info.name == "cpu" || info.hardware) << info.name << ": " << info.renderer;
}

TEST(CreateDevice, ABackendThatIsNoneIsAnsweredWithThoseThatAre) {
    const auto device = createDevice({"vulkan", 0, -1});
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(device.error().field, "backend");
    EXPECT_THAT(device.error().message, HasSubstr("vulkan"));
    EXPECT_THAT(device.error().message, HasSubstr("auto, cpu, egl or osmesa"));
}

TEST(CreateDevice, AnEglDeviceNeedsEgl) {
    const auto device = createDevice({"cpu", 0, 0});
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().field, "egl-device");
}

}  // namespace
}  // namespace scancast
