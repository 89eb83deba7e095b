// Eye-dome lighting against its formula (docs/spec/shading.md §3), computed in double from the frame's own
// depths.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/reference_renderer.hpp"

namespace scancast::test {
namespace {

class EyeDome : public OnDevice {};
SCANCAST_ON_DEVICES(EyeDome, "egl");

/// The plane y = depth(x), one white point every half pixel or closer.
template <class Depth>
AnalyticCloud relief(const Depth& depth) {
    std::vector<AnalyticPoint> points;
    for (double x = -4; x <= 4; x += 0.02) {
        for (double z = -3; z <= 3; z += 0.02) {
            AnalyticPoint p;
            p.position = {x, depth(x), z};
            p.rgb = {250, 200, 150};
            points.push_back(p);
        }
    }
    return {points, 0.02};
}

const Viewpoint view = lookAtOrthographic({0, -10, 0}, {0, 0, 0}, 160, 120, 6);

TEST_P(EyeDome, LeavesAFacingPlaneUnshaded) {
    // All neighbours are equally deep: the response is 0 and the shade exactly 1.
    const AnalyticCloud cloud = relief([](double) { return 0.0; });
    Scene scene(view, cloud.cut(), sprite(Footprint::Square, Profile::Flat, 2));
    scene.addEyeDome();
    const Frame frame = mustDraw(*device_, scene.drawing);
    for (int y = 1; y < 119; ++y) {
        for (int x = 1; x < 159; ++x) ASSERT_EQ(pixel(frame, x, y), (Rgb8{250, 200, 150})) << x << ", " << y;
    }
}

TEST_P(EyeDome, DarkensOnlyTheFarSideOfAStep) {
    // Only neighbours that are nearer darken: the near side has none.
    const AnalyticCloud cloud = relief([](double x) { return x < 0 ? 0.0 : 0.5; });
    Scene scene(view, cloud.cut(), sprite(Footprint::Pixel, Profile::Flat, 1));
    scene.addEyeDome();
    const Frame frame = mustDraw(*device_, scene.drawing);
    for (int y = 2; y < 118; ++y) {
        for (int x = 2; x < 158; ++x) {
            const bool far = depth(frame, x, y) > 10.2f, besideNear = depth(frame, x - 1, y) < 10.2f;
            if (far && besideNear) {
                EXPECT_LT(pixel(frame, x, y)[0], 200);
            } else if (!far) {
                EXPECT_EQ(pixel(frame, x, y)[0], 250);
            }
        }
    }
}

TEST_P(EyeDome, FollowsItsFormula) {
    Numbers numbers(51);
    std::vector<AnalyticPoint> points(30000);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere() * 2.5;
        p.rgb = numbers.color();
    }
    const AnalyticCloud cloud(points, 0.04);
    const Viewpoint sphere = lookAt({5, 1, 2}, {0, 0, 0}, 200, 150);
    for (const EyeDomePass pass :
         {EyeDomePass{}, EyeDomePass{0.05f, 1.4f}, EyeDomePass{0.1f, 3.0f}, EyeDomePass{0.0f, 1.0f}}) {
        Scene plain(sphere, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 3));
        const Frame unlit = mustDraw(*device_, plain.drawing);
        Scene scene(sphere, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 3));
        scene.addEyeDome(pass);
        const Frame lit = mustDraw(*device_, scene.drawing);
        ASSERT_EQ(lit.depth, unlit.depth) << "lighting changes colours only";
        int darker = 0;
        for (int y = 0; y < 150; ++y) {
            for (int x = 0; x < 200; ++x) {
                const bool background = std::isinf(depth(lit, x, y));
                const double shade = background ? 1 : referenceEyeDome(unlit, x, y, pass);
                for (int c = 0; c < 3; ++c) {
                    ASSERT_NEAR(pixel(lit, x, y)[c], pixel(unlit, x, y)[c] * shade, 0.55) << x << ", " << y;
                }
                darker += shade < 0.9 ? 1 : 0;
            }
        }
        EXPECT_EQ(darker > 1000, pass.strength > 0.01f);
    }
}

}  // namespace
}  // namespace scancast::test
