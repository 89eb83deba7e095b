// A frame has what was asked for: without depth the same colours, and no depth, on every device alike.
#include <gtest/gtest.h>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/reference_renderer.hpp"

namespace scancast::test {
namespace {

class Wanted : public OnDevice {
  protected:
    static AnalyticCloud ball() {
        Numbers numbers(3);
        std::vector<AnalyticPoint> points;
        for (int i = 0; i < 3000; ++i) points.push_back({numbers.onSphere(), numbers.color()});
        return {points, 0.05};
    }
};
SCANCAST_ON_DEVICES(Wanted, "egl", "osmesa");

/// Oracle: the same drawing with depth. With one frame and several, where passes need depths and where they
/// look beyond the window.
TEST_P(Wanted, NoDepthUnlessAskedFor) {
    const AnalyticCloud cloud = ball();
    const Viewpoint from = lookAt({0.3, -3, 1}, {0, 0, 0}, 90, 70);
    const glm::dvec2 shifts[] = {{-0.25, 0.1}, {0.25, -0.1}, {0, 0.3}};
    const std::span<const glm::dvec2> one(&noJitter, 1), several(shifts);
    for (const bool eyeDome : {false, true}) {
        Scene scene(from, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 5));
        if (eyeDome) scene.addEyeDome();
        for (const std::span<const glm::dvec2> jitter : {one, several}) {
            for (const Window window : {Window{0, 0, 90, 70}, Window{20, 10, 41, 37}}) {
                scene.drawing.jitter = jitter;
                scene.drawing.window = window;
                scene.drawing.depth = true;
                const Frame with = mustDraw(*device_, scene.drawing);
                scene.drawing.depth = false;
                const Frame without = mustDraw(*device_, scene.drawing);
                EXPECT_EQ(with.rgba, without.rgba);
                EXPECT_EQ(with.depth.size() * 4, with.rgba.size());
                EXPECT_TRUE(without.depth.empty());
                EXPECT_FALSE(without.rgba.empty());
            }
        }
    }
}

/// A GPU's pixels are lent from where they arrived, those of a device that draws in memory are its own.
TEST_P(Wanted, FramesAliveAtOnceAreTheirOwn) {
    const AnalyticCloud cloud = ball();
    const Viewpoint from = lookAt({0.3, -3, 1}, {0, 0, 0}, 60, 40);
    Scene scene(from, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 5));
    std::vector<Frame> frames;
    std::vector<std::vector<std::uint8_t>> bytes;
    for (int i = 0; i < 5; ++i) {
        scene.drawing.background.top = {static_cast<std::uint8_t>(50 * i), 0, 0};
        frames.push_back(mustDraw(*device_, scene.drawing));
        bytes.emplace_back(frames.back().rgba.begin(), frames.back().rgba.end());
        EXPECT_EQ(frames.back().rgba.lent(), device_->info().name != "cpu");
        EXPECT_EQ(frames.back().depth.lent(), device_->info().name != "cpu");
    }
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(frames[i].rgba, bytes[i]) << i;
    EXPECT_NE(bytes[0], bytes[1]);
}

}  // namespace
}  // namespace scancast::test
