// Runs that are drawn in part against runs of only the samples that are drawn. Right because the kernels then
// know nothing of shares: which samples are drawn is computed here, one by one.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/faded_cut.hpp"

namespace scancast::test {
namespace {

/// Leaves of several slices and blocks, and of an odd number of samples.
AnalyticCloud ball() {
    Numbers numbers(88);
    std::vector<AnalyticPoint> points(61'003);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere();
        p.rgb = numbers.color();
        p.normal = encodeNormal(glm::vec3(p.position));
    }
    return {points, 0.02, 20'000};
}

/// On a GL device, or on the cpu device with the kernels of one SIMD level.
class RunsInPart : public testing::TestWithParam<std::string> {
  protected:
    void SetUp() override {
        if (GetParam()[0] == 'v') {
            setenv("SCANCAST_SIMD", GetParam().c_str(), 1);
            auto cpu = createCpuDevice(2);
            unsetenv("SCANCAST_SIMD");
            if (!cpu) GTEST_SKIP() << cpu.error().message;
            own_ = std::move(*cpu);
            device_ = own_.get();
        } else {
            REQUIRE_DEVICE(gl, GetParam());
            device_ = gl;
        }
    }
    Device* device_ = nullptr;

  private:
    std::unique_ptr<Device> own_;
};
INSTANTIATE_TEST_SUITE_P(Cpu, RunsInPart, testing::Values("v2", "v3", "v4"), deviceName);
INSTANTIATE_TEST_SUITE_P(Gl, RunsInPart, testing::Values("egl"), deviceName);

TEST_P(RunsInPart, AreTheirDrawnSamples) {
    const AnalyticCloud cloud = ball();
    const Cut faded = withShares(cloud.cut());
    const DrawnOnly drawn(faded);
    ASSERT_LT(drawn.cut().samples, faded.samples * 3 / 4);
    const Viewpoint view = lookAt({0, -2.5, 0.4}, {0, 0, 0}, 311, 233);
    for (const float px : {1.0f, 3.0f, 6.5f, 20.0f}) {
        const NearestPass circles = sprite(Footprint::Circle, Profile::Paraboloid, px);
        const Scene inPart(view, faded, circles), whole(view, drawn.cut(), circles),
            all(view, cloud.cut(), circles);
        const Frame a = mustDraw(*device_, inPart.drawing), b = mustDraw(*device_, whole.drawing);
        EXPECT_EQ(a.rgba, b.rgba) << px;
        EXPECT_EQ(a.depth, b.depth) << px;
        EXPECT_NE(a.rgba, mustDraw(*device_, all.drawing).rgba) << px;
    }
}

TEST_P(RunsInPart, AreTheirDrawnSamplesInEveryMethod) {
    const AnalyticCloud cloud = ball();
    const Cut faded = withShares(cloud.cut());
    const DrawnOnly drawn(faded);
    const Viewpoint view = lookAt({0, -2.5, 0.4}, {0, 0, 0}, 311, 233);
    for (const Method& method : methods()) {
        const ParameterValues values = resolveParameters(method, {}).value();
        if (method.passes == nullptr) continue;
        Scene scene(view, faded, {});
        scene.drawing.surfels = scene.drawing.oriented = true;
        scene.passes = method.passes({method,
                                      values,
                                      method.defaultShading,
                                      {.surfels = true, .oriented = true, .normals = true, .spacing = 0.02},
                                      2});
        scene.drawing.passes = scene.passes;
        const Frame a = mustDraw(*device_, scene.drawing);
        scene.drawing.view().cut = drawn.cut();
        const Frame b = mustDraw(*device_, scene.drawing);
        EXPECT_EQ(a.rgba, b.rgba) << method.name;
        EXPECT_EQ(a.depth, b.depth) << method.name;
    }
}

}  // namespace
}  // namespace scancast::test
