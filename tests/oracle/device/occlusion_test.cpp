// Ambient occlusion against its formula (docs/spec/shading.md §9), computed in double from the frame's own depths, and on
// scenes of which one knows what it must do.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"

namespace scancast::test {
namespace {

class Occlusion : public OnDevice {};
SCANCAST_ON_DEVICES(Occlusion, "egl");

constexpr double quarterTurn = 1.57079632679489661923;

double occlusionAt(const Frame& frame, const Viewpoint& view, int x, int y, const OcclusionPass& pass,
                   const glm::dvec2& jitter) {
    const bool perspective = view.projection == Projection::Perspective;
    const auto nearness = [&](int i, int j) {
        const bool inside = i >= 0 && i < frame.width && j >= 0 && j < frame.height;
        const double d = inside ? depth(frame, i, j) : INFINITY;
        return perspective ? 1 / d : -d;
    };
    const auto isKnown = [&](double value) { return perspective ? value > 0 : value > -INFINITY; };
    const double own = nearness(x, y), scale = perspective ? depth(frame, x, y) : 1;
    double sum = 0;
    for (int ring = 0; ring < 6; ++ring) {
        for (int line = 0; line < 4; ++line) {
            const double radius =
                std::clamp(double(pass.radiusPx), 0.0, 64.0) * (1 + 0.4 * jitter.y) * std::pow(0.6, ring);
            const double angle = quarterTurn / 2 * (line + 0.618033988749894848 * ring + jitter.x);
            const int dx = int(std::lround(radius * std::cos(angle)));
            const int dy = int(std::lround(radius * std::sin(angle)));
            const int px = dx == 0 && dy == 0 ? 1 : dx;
            const double a = nearness(x + px, y + dy), b = nearness(x - px, y - dy);
            if (!isKnown(a) && !isKnown(b)) continue;
            const double perPx = scale * view.pixelsPerUnit / std::hypot(px, dy);
            const double riseA = isKnown(a) ? (a - own) * perPx : -(b - own) * perPx;
            const double riseB = isKnown(b) ? (b - own) * perPx : -(a - own) * perPx;
            const auto beyond = [](double rise) { return std::clamp((rise - 1.5) / 2.5, 0.0, 1.0); };
            const double mean =
                std::clamp((riseA + riseB) / 2 * (1 - beyond(riseA) - beyond(riseB)), 0.0, 1000.0);
            sum += mean * mean / (1 + mean * mean);
        }
    }
    return std::exp2(-4 * pass.strength * sum / 24);
}

/// The surface y = depth(x, z), white, one point every half pixel or closer.
template <class Depth>
AnalyticCloud undulating(const Depth& depthAt) {
    std::vector<AnalyticPoint> points;
    for (double x = -4; x <= 4; x += 0.02) {
        for (double z = -3; z <= 3; z += 0.02) {
            AnalyticPoint p;
            p.position = {x, depthAt(x, z), z};
            p.rgb = {250, 200, 150};
            points.push_back(p);
        }
    }
    return {points, 0.02};
}

const Viewpoint front = lookAtOrthographic({0, -10, 0}, {0, 0, 0}, 160, 120, 5);

Frame occluded(Device& device, const Viewpoint& view, const AnalyticCloud& cloud, OcclusionPass pass) {
    Scene scene(view, cloud.cut(), sprite(Footprint::Square, Profile::Flat, 3));
    scene.add(pass);
    return mustDraw(device, scene.drawing);
}

TEST_P(Occlusion, FollowsItsFormula) {
    Numbers numbers(53);
    std::vector<AnalyticPoint> points(30'000);
    for (std::size_t i = 0; i < points.size(); ++i) {
        // A bowl, seen from above its rim, and a ball in it.
        const glm::dvec3 place = numbers.onSphere();
        points[i].position =
            i % 3 == 0 ? place * 0.8 : glm::dvec3(place.x, place.y, -std::abs(place.z)) * 2.5;
        points[i].rgb = numbers.color();
    }
    const AnalyticCloud cloud(points, 0.04);
    const glm::dvec2 jitters[] = {{0, 0}, {0.3, -0.4}};
    for (const Viewpoint& view : {lookAt({4, 1, 4}, {0, 0, -0.5}, 200, 150),
                                  lookAtOrthographic({4, 1, 4}, {0, 0, -0.5}, 200, 150, 6)}) {
        for (const OcclusionPass pass :
             {OcclusionPass{1, 20}, OcclusionPass{0.4f, 7.5f}, OcclusionPass{1, 1000}, OcclusionPass{0.7f, 0},
              OcclusionPass{0, 20}}) {
            for (const glm::dvec2& jitter : jitters) {
                Scene plain(view, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 4));
                plain.drawing.jitter = {&jitter, 1};
                const Frame unlit = mustDraw(*device_, plain.drawing);
                Scene scene(view, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 4));
                scene.drawing.jitter = {&jitter, 1};
                scene.add(pass);
                const Frame lit = mustDraw(*device_, scene.drawing);
                ASSERT_EQ(lit.depth, unlit.depth) << "it changes colours only";
                int darker = 0;
                for (int y = 0; y < 150; ++y) {
                    for (int x = 0; x < 200; ++x) {
                        const bool background = std::isinf(depth(lit, x, y));
                        const double shade = background ? 1 : occlusionAt(unlit, view, x, y, pass, jitter);
                        for (std::size_t c = 0; c < 3; ++c) {
                            ASSERT_NEAR(pixel(lit, x, y)[c], pixel(unlit, x, y)[c] * shade, 0.6)
                                << x << ", " << y;
                        }
                        darker += shade < 0.97 ? 1 : 0;
                    }
                }
                EXPECT_EQ(darker > 200, pass.strength > 0.01f);
            }
        }
    }
}

TEST_P(Occlusion, LeavesPlanesAloneHoweverTheyLie) {
    // Right because 1/depth, or depth without perspective, is linear over a plane: opposite neighbours cancel out.
    for (const double steepness : {0.0, 0.5, 2.0}) {
        const AnalyticCloud cloud = undulating([&](double x, double z) { return steepness * (x + 0.3 * z); });
        for (const Viewpoint& view : {front, lookAt({0, -10, 0}, {0, 0, 0}, 160, 120, 25)}) {
            // Of squares 3 px wide each is flat: a staircase, which rings of few pixels see.
            const Frame frame = occluded(*device_, view, cloud, {1, 60});
            double sum = 0;
            int shown = 0;
            for (int y = 30; y < 90; ++y) {
                for (int x = 30; x < 130; ++x) {
                    if (std::isinf(depth(frame, x, y))) continue;
                    sum += pixel(frame, x, y)[0];
                    ++shown;
                }
            }
            ASSERT_GT(shown, 3000);
            EXPECT_GT(sum / shown, steepness > 1 ? 245 : 249.5) << steepness;
        }
    }
}

TEST_P(Occlusion, DarkensTheBottomOfAGroove) {
    const AnalyticCloud cloud =
        undulating([](double x, double) { return std::abs(x) < 1 ? 1 - std::abs(x) : 0.0; });
    const Frame frame = occluded(*device_, front, cloud, {1, 24});
    EXPECT_LT(pixel(frame, 80, 60)[0], 170) << "the bottom";
    EXPECT_GT(pixel(frame, 56, 60)[0], 225) << "the rim";
    EXPECT_EQ(pixel(frame, 20, 60)[0], 250) << "beside it";
}

TEST_P(Occlusion, CastsNoHaloOnWhatLiesFarBehind) {
    // Right because the step is 20 times as deep as the rings are wide: it stands before the wall, not on it.
    const AnalyticCloud cloud = undulating([](double x, double) { return x < 0 ? -8.0 : 8.0; });
    const Frame frame =
        occluded(*device_, lookAtOrthographic({0, -20, 0}, {0, 0, 0}, 160, 120, 5), cloud, {1, 10});
    for (int y = 20; y < 100; ++y) {
        for (int x = 20; x < 140; ++x) ASSERT_EQ(pixel(frame, x, y)[0], 250) << x << ", " << y;
    }
}

TEST_P(Occlusion, BackgroundDarkensNobodyAndStaysAsItIs) {
    // A lonely ball: bulging everywhere, so nothing of it is hidden, and behind it there is nothing.
    std::vector<AnalyticPoint> points(60'000);
    Numbers numbers(7);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere();
        p.rgb = {250, 200, 150};
    }
    const AnalyticCloud cloud(points, 0.02);
    const Viewpoint view = lookAt({0, -4, 0}, {0, 0, 0}, 160, 120, 40);
    Scene scene(view, cloud.cut(), sprite(Footprint::Pixel, Profile::Flat, 1));
    scene.add(OcclusionPass{1, 30});
    const Frame frame = mustDraw(*device_, scene.drawing);
    double sum = 0;
    int shown = 0;
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
            if (std::isinf(depth(frame, x, y))) {
                EXPECT_EQ(pixel(frame, x, y), (Rgb8{0, 0, 0}));
                continue;
            }
            if (depth(frame, x, y) > 4) continue;  // its far side, seen through a gap
            sum += pixel(frame, x, y)[0];
            ++shown;
        }
    }
    EXPECT_GT(sum / shown, 248);
}

}  // namespace
}  // namespace scancast::test
