// The gl device against pictures known in advance: no other device is asked.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/pictures/analytic_cut.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/reference_renderer.hpp"

namespace scancast::test {
namespace {

constexpr Rgb8 black{0, 0, 0};

class GlPicture : public testing::TestWithParam<std::string> {
  protected:
    static OwnDrawing onBlack(const Viewpoint& from, const Cut& cut, std::span<const Pass> passes) {
        OwnDrawing d(from, cut, passes);
        d.background = {Background::Kind::Color, black, black};
        return d;
    }
    static Rgb8 at(const Frame& f, int x, int y) {
        const auto i = static_cast<std::size_t>(y * f.width + x) * 4;
        return {f.rgba[i], f.rgba[i + 1], f.rgba[i + 2]};
    }
};
INSTANTIATE_TEST_SUITE_P(Gl, GlPicture, testing::Values("egl", "osmesa"),
                         [](const testing::TestParamInfo<std::string>& c) { return c.param; });

const PassList onePixelPoints{NearestPass{{Footprint::Pixel, Profile::Flat, {}, 0}}, ResolvePass{}};

/// Oracle: in front of an orthographic camera that shows one unit a pixel, a point's pixel is its own
/// coordinates.
TEST_P(GlPicture, PointsLandOnTheirPixels) {
    REQUIRE_DEVICE(gl, GetParam());
    std::vector<AnalyticPoint> cloudPoints;
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 30; ++x)
            cloudPoints.push_back({{x + 0.5, 10.0 + x * 0.01, y + 0.5},
                                   {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 77}});
    }
    const AnalyticCloud cloud(cloudPoints, 1);
    const Viewpoint from = lookAtOrthographic({15, 0, 10}, {15, 1, 10}, 30, 20, 20);
    const auto frame = gl->draw(onBlack(from, cloud.cut(), onePixelPoints), {});
    ASSERT_TRUE(frame) << frame.error().message;
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 30; ++x) {
            const Rgb8 expected{static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(19 - y), 77};
            EXPECT_EQ(at(*frame, x, y), expected) << x << ", " << y;
            EXPECT_NEAR(frame->depth[static_cast<std::size_t>(y * 30 + x)], 10.0 + x * 0.01, 1e-4);
        }
    }
}

/// Oracle: of a stack of points on the view axis the first is seen, whatever their order in memory. Depths
/// are further apart than the sample's grid, so no two are equal.
TEST_P(GlPicture, TheNearestOfManyWins) {
    REQUIRE_DEVICE(gl, GetParam());
    constexpr int count = 30000;
    Numbers numbers(5);
    std::vector<AnalyticPoint> stack;
    for (int i = 0; i < count; ++i)
        stack.push_back({{0, 2 + (i * 7919 + 123) % count * 2e-4, 0}, numbers.color()});
    const AnalyticPoint first =
        *std::ranges::min_element(stack, {}, [](const auto& p) { return p.position.y; });
    const AnalyticCloud cloud(stack, 1, 1u << 20, false);
    const Viewpoint from = lookAt({0, 0, 0}, {0, 1, 0}, 5, 5);
    const auto frame = gl->draw(onBlack(from, cloud.cut(), onePixelPoints), {});
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(at(*frame, 2, 2), first.rgb);
    EXPECT_NEAR(frame->depth[12], first.position.y, 1e-6);
    EXPECT_TRUE(std::isinf(frame->depth[0]));
    EXPECT_EQ(at(*frame, 0, 0), black);
}

/// Oracle: equal discs on a plane facing the viewer show, as paraboloids, the Voronoi diagram of their
/// centres (docs/spec/sprites.md §3), here by brute force in double.
TEST_P(GlPicture, EqualParaboloidsShowTheVoronoiDiagram) {
    REQUIRE_DEVICE(gl, GetParam());
    constexpr int side = 160;
    constexpr double radius = 9;
    Numbers numbers(9);
    std::vector<AnalyticPoint> centres;
    for (int i = 0; i < 300; ++i)
        centres.push_back({{numbers.uniform(0, side), 50, numbers.uniform(0, side)}, numbers.color()});
    const AnalyticCloud cloud(centres, 1);
    const Viewpoint from =
        lookAtOrthographic({side / 2.0, 0, side / 2.0}, {side / 2.0, 1, side / 2.0}, side, side, side);
    const PassList paraboloids{
        NearestPass{{Footprint::Circle, Profile::Paraboloid, {2 * radius, 1, 1, 50}, 2}}, ResolvePass{}};
    const auto frame = gl->draw(onBlack(from, cloud.cut(), paraboloids), {});
    ASSERT_TRUE(frame) << frame.error().message;
    int covered = 0, right = 0;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const AnalyticPoint* best = nullptr;
            double bestDistance = radius;
            for (const AnalyticPoint& c : centres) {
                const double d = std::hypot(c.position.x - (x + 0.5), c.position.z - (side - y - 0.5));
                if (d <= bestDistance) {
                    bestDistance = d;
                    best = &c;
                }
            }
            if (!best) continue;
            ++covered;
            right += at(*frame, x, y) == best->rgb;
        }
    }
    ASSERT_GT(covered, side * side / 2);
    EXPECT_GE(right, 0.995 * covered);
}

/// Oracle: p × p pixel centres lie in any half-open square of p px, also where its border runs through some.
TEST_P(GlPicture, SquaresOfWholePixelsCoverTheirArea) {
    REQUIRE_DEVICE(gl, GetParam());
    for (const double shift : {0.0, 0.5, 0.3}) {
        const std::vector<AnalyticPoint> one{{{15 + shift, 10, 15 + shift}}};
        const AnalyticCloud cloud(one, 1);
        const Viewpoint from = lookAtOrthographic({15, 0, 15}, {15, 1, 15}, 30, 30, 30);
        for (const int side : {1, 2, 3, 4, 5, 8, 12}) {
            const PassList squares{
                NearestPass{{Footprint::Square, Profile::Flat, {static_cast<float>(side), 1, 1, 50}, 0}},
                ResolvePass{}};
            const auto frame = gl->draw(onBlack(from, cloud.cut(), squares), {});
            ASSERT_TRUE(frame) << frame.error().message;
            EXPECT_EQ(std::ranges::count_if(frame->depth, [](float d) { return std::isfinite(d); }),
                      side * side);
        }
    }
}

/// Oracle: the reference renderer, in double and sharing no code with any device. Its order and a float's
/// differ by rounding; its winner, where another sample is as near to within rounding.
TEST_P(GlPicture, EverySpriteIsTheReferences) {
    REQUIRE_DEVICE(gl, GetParam());
    Numbers numbers(21);
    std::vector<AnalyticPoint> ball;
    for (int i = 0; i < 3000; ++i) ball.push_back({numbers.onSphere(), numbers.color()});
    const AnalyticCloud cloud(ball, 0.05);
    const Viewpoint views[] = {lookAt({0.3, -3, 1}, {0, 0, 0}, 160, 120),
                               lookAtOrthographic({0.3, -3, 1}, {0, 0, 0}, 160, 120, 2.5)};
    for (const Viewpoint& from : views) {
        for (const Profile profile : {Profile::Flat, Profile::Paraboloid, Profile::Cone, Profile::Sphere}) {
            const PassList sprites{NearestPass{{Footprint::Circle, profile, {}, 2}}, ResolvePass{}};
            const OwnDrawing drawing = onBlack(from, cloud.cut(), sprites);
            const auto frame = gl->draw(drawing, {});
            ASSERT_TRUE(frame) << frame.error().message;
            const ReferencePicture expected = referenceNearest(drawing);
            int covered = 0, right = 0;
            for (int y = 0; y < frame->height; ++y) {
                for (int x = 0; x < frame->width; ++x) {
                    const ReferenceFragment& fragment = expected.at(x, y);
                    if (!std::isfinite(fragment.order)) continue;
                    ++covered;
                    const float depth = frame->depth[static_cast<std::size_t>(y * frame->width + x)];
                    right += at(*frame, x, y) == fragment.color && std::abs(depth - fragment.order) < 1e-5;
                }
            }
            ASSERT_GT(covered, 4000);
            EXPECT_GE(right, 0.995 * covered);
            EXPECT_NEAR(std::ranges::count_if(frame->depth, [](float d) { return std::isfinite(d); }),
                        covered, 3);
        }
    }
}

TEST_P(GlPicture, AnEmptyCutIsBackground) {
    REQUIRE_DEVICE(gl, GetParam());
    const Cut nothing;
    const Viewpoint from = lookAt({0, 0, 0}, {0, 1, 0}, 17, 9);
    const auto frame = gl->draw(onBlack(from, nothing, onePixelPoints), {});
    ASSERT_TRUE(frame) << frame.error().message;
    for (int y = 0; y < 9; ++y) {
        for (int x = 0; x < 17; ++x) EXPECT_EQ(at(*frame, x, y), black);
    }
}

/// A picture that was drawn before, smaller or larger, leaves no trace in the next.
TEST_P(GlPicture, PicturesLeaveNoTrace) {
    REQUIRE_DEVICE(gl, GetParam());
    Numbers numbers(13);
    std::vector<AnalyticPoint> ball;
    for (int i = 0; i < 20000; ++i) ball.push_back({numbers.onSphere(), numbers.color()});
    const AnalyticCloud cloud(ball, 0.03);
    const Viewpoint small = lookAt({0, -3, 0}, {0, 0, 0}, 90, 70),
                    large = lookAt({0, -3, 0}, {0, 0, 0}, 300, 200);
    const auto first = gl->draw(onBlack(small, cloud.cut(), onePixelPoints), {});
    ASSERT_TRUE(first) << first.error().message;
    ASSERT_TRUE(gl->draw(onBlack(large, cloud.cut(), onePixelPoints), {}));
    std::stop_source stopped;
    stopped.request_stop();
    const auto abandoned = gl->draw(onBlack(large, cloud.cut(), onePixelPoints), stopped.get_token());
    ASSERT_FALSE(abandoned);
    EXPECT_EQ(abandoned.error().code, ErrorCode::Cancelled);
    const auto again = gl->draw(onBlack(small, cloud.cut(), onePixelPoints), {});
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(first->rgba, again->rgba);
    EXPECT_EQ(first->depth, again->depth);
}

TEST_P(GlPicture, WhatItCannotDrawIsSaid) {
    REQUIRE_DEVICE(gl, GetParam());
    const Cut nothing;
    const Viewpoint from = lookAt({0, 0, 0}, {0, 1, 0}, 16384, 16384);
    OwnDrawing huge = onBlack(from, nothing, onePixelPoints);
    const auto tooLarge = gl->draw(huge, {});
    ASSERT_FALSE(tooLarge);
    EXPECT_EQ(tooLarge.error().code, ErrorCode::ResourceLimit);

    huge.window = {16380, 0, 5, 5};
    const auto outside = gl->draw(huge, {});
    ASSERT_FALSE(outside);
    EXPECT_EQ(outside.error().code, ErrorCode::InvalidArgument);

    const PassList twice{ResolvePass{}, ResolvePass{}};
    huge.window = {0, 0, 5, 5};
    huge.passes = twice;
    const auto unknown = gl->draw(huge, {});
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, ErrorCode::Unsupported);
}

}  // namespace
}  // namespace scancast::test
