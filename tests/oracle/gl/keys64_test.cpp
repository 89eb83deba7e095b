// Keys of 64 bits in one dispatch, as graphics cards with GL_NV_shader_atomic_int64 keep them. Mesa's
// software rasteriser has such atomics, too, and does not offer the extension: told to, it does
// (MESA_EXTENSION_OVERRIDE, read when the driver is opened; hence a program of its own). Oracle: the cpu
// device's bytes, in every method.
#include <gtest/gtest.h>

#include <cstdlib>

#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/pictures/agreement.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

class Keys64 : public OnDevice {
  protected:
    static void SetUpTestSuite() {
        ASSERT_EQ(setenv("MESA_EXTENSION_OVERRIDE", "+GL_NV_shader_atomic_int64", 1), 0);
    }
};
INSTANTIATE_TEST_SUITE_P(Gl, Keys64, testing::Values("egl"), deviceName);

TEST_P(Keys64, GiveTheCpusBytesInEveryMethodAndProjection) {
    REQUIRE_DEVICE(cpu, "cpu");
    if (!device_->info().atomics64) GTEST_SKIP() << "MISSING: 64-bit atomics in " << title(device_->info());
    const auto cloud = sceneCloud("room", 50'000).value();
    for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
        View view = sceneView(*cloud, sceneViews("room")[0], projection, 301, 203);
        for (const Method& method : methods()) {
            if (method.name == automaticName) continue;
            SCOPED_TRACE(method.name + ", " + std::string(name(projection)));
            view.style.method = method.name;
            const auto a = render(*device_, *cloud, view), b = render(*cpu, *cloud, view);
            ASSERT_TRUE(b) << b.error().message;
            ASSERT_TRUE(a) << a.error().message;
            const Agreement agreement = agreementOf(*a, *b);
            EXPECT_GE(agreement.psnr, 45);
            EXPECT_GT(agreement.part(agreement.covered), 0.05) << "a picture of nothing proves nothing";
            if (device_->info().exact) {
                EXPECT_TRUE(agreement.identical())
                    << agreement.changed << " pixels and " << agreement.changedDepth << " depths differ";
            }
        }
    }
}

// As a graphics card adds them up: in tiles in shared memory first, then by 64-bit atomics. A rasteriser has no tiles unless told.
TEST_P(Keys64, SumsInTilesToo) {
    REQUIRE_DEVICE(cpu, "cpu");
    if (!device_->info().atomics64) GTEST_SKIP() << "MISSING: 64-bit atomics in " << title(device_->info());
    DeviceOptions options;
    options.backend = GetParam();
    options.sumTiles = true;
    const auto tiled = createDevice(options);
    ASSERT_TRUE(tiled) << tiled.error().message;
    const auto cloud = sceneCloud("room", 20'000).value();
    View view = sceneView(*cloud, sceneViews("room")[0], Projection::Perspective, 161, 113);
    for (const char* method : {"hqs", "ewa", "voronoi"}) {
        SCOPED_TRACE(method);
        view.style.method = method;
        const auto a = render(**tiled, *cloud, view), b = render(*cpu, *cloud, view);
        ASSERT_TRUE(a && b);
        const Agreement agreement = agreementOf(*a, *b);
        EXPECT_GE(agreement.psnr, 45);
        EXPECT_GT(agreement.part(agreement.covered), 0.05) << "a picture of nothing proves nothing";
        if ((*tiled)->info().exact) {
            EXPECT_TRUE(agreement.identical()) << agreement.changed << " differ";
        }
    }
}

}  // namespace
}  // namespace scancast::test
