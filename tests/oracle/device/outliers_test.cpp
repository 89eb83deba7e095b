// Outliers, on every device: no method draws them unless the view asks for it, and then they are dots.
#include <gtest/gtest.h>

#include "tests/oracle/device/surfel_scenes.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

class Outlying : public OnDevice {};
SCANCAST_ON_DEVICES(Outlying, "egl");

constexpr std::uint8_t outlying = 7;

/// A ball of discs, every ninth of which is an outlier, or a dot of the smallest radius.
AnalyticCloud ballWith(bool outliers) {
    Numbers numbers(61);
    std::vector<AnalyticPoint> points(3000);
    for (std::size_t i = 0; i < points.size(); ++i) {
        AnalyticPoint& p = points[i];
        const bool far = i % 9 == 0;
        p.position = numbers.onSphere() * (far ? 1.3 : 1.0);
        p.rgb = numbers.color();
        p.classification = far ? outlying : 2;
        p.surfel = surfelOf(p.position, far ? 1e-6 : 0.05);
        p.surfel->outlier = far && outliers;
    }
    return {points, 0.05, 500};
}

Frame drawn(Device& device, const AnalyticCloud& cloud, const PassList& passes, bool outliers, bool byClass) {
    SurfelScene scene(lookAt({0, -4, 1}, {0, 0, 0}, 160, 120, 40), cloud.cut(), passes);
    scene.drawing.view().filter.outliers = outliers;
    if (byClass) {
        auto& classes = scene.drawing.view().filter.classes.emplace();
        classes.fill(true);
        classes[outlying] = false;
    }
    return mustDraw(device, scene.drawing);
}

PassList spritePasses() {
    NearestPass pass;
    pass.footprint = Footprint::Circle;
    pass.profile = Profile::Paraboloid;
    pass.gain = 2;
    return {pass, ResolvePass{}};
}
PassList spritePassesOfOneSize() {
    return {sprite(Footprint::Square, Profile::Flat, 5), ResolvePass{}};
}

// Right because a class of their own, left out, leaves the rest as it is.
TEST_P(Outlying, AreNotDrawnByAnyMethod) {
    const AnalyticCloud cloud = ballWith(true);
    for (const PassList& passes : {spritePasses(), spritePassesOfOneSize(), discPasses(), ewaPasses()}) {
        const Frame hidden = drawn(*device_, cloud, passes, false, false);
        EXPECT_EQ(hidden.rgba, drawn(*device_, cloud, passes, true, true).rgba);
        EXPECT_NE(hidden.rgba, drawn(*device_, cloud, passes, true, false).rgba);
    }
}

// Right because that is what a sample of the smallest radius is.
TEST_P(Outlying, AreDotsWhereAskedFor) {
    const AnalyticCloud outliers = ballWith(true), dots = ballWith(false);
    for (const PassList& passes : {spritePasses(), spritePassesOfOneSize(), discPasses()}) {
        const Frame frame = drawn(*device_, outliers, passes, true, false);
        EXPECT_EQ(frame.rgba, drawn(*device_, dots, passes, false, false).rgba);
    }
}

}  // namespace
}  // namespace scancast::test
