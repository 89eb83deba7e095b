// Oriented discs: docs/spec/surfels.md §3.
#include <gtest/gtest.h>

#include "tests/oracle/device/surfel_scenes.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

class Discs : public OnDevice {};
SCANCAST_ON_DEVICES(Discs, "egl");
class Surfels : public OnDevice {};
SCANCAST_ON_DEVICES(Surfels, "egl");

Rgb8 grey(double, double) {
    return {128, 128, 128};
}

/// Share of the picture's pixels in which nothing is; the plane fills it, so each is a hole.
double holes(const Frame& frame) {
    const auto empty = std::ranges::count_if(frame.depth, [](float d) { return std::isinf(d); });
    return double(empty) / double(frame.depth.size());
}

/// Points strewn over a plane at random: the worst that a surface scanned well can be.
std::vector<AnalyticPoint> strewn(double spacing) {
    Numbers numbers(71);
    std::vector<AnalyticPoint> points(static_cast<std::size_t>(16 / (spacing * spacing)));
    for (AnalyticPoint& p : points) p.position = {numbers.uniform(-2, 2), numbers.uniform(-2, 2), 0};
    estimate(points);
    return points;
}

// Right because the plane reaches beyond every border of the picture: whatever shows the background is a
// hole. docs/spec/surfels.md §6: discs of r/2 leave 10-23 % of them; ellipses leave 0.3 %, with the plain
// ratio of the paper 1.8 %.
TEST_P(Discs, CloseTheSurface) {
    double ewa = 0, plain = 0, pictures = 0;
    for (const double spacing : {0.02, 0.035}) {
        std::vector<AnalyticPoint> points = strewn(spacing);
        const AnalyticCloud cloud(points, spacing);
        for (AnalyticPoint& p : points) p.surfel->minor *= p.surfel->minor / p.surfel->major;
        const AnalyticCloud narrow(points, spacing);
        for (const Viewpoint& view :
             {lookAt({0, 0, 2}, {0, 0, 0}, 320, 240, 60), lookAt({0.6, -0.5, 1.2}, {0, 0, 0}, 640, 480, 45),
              lookAtOrthographic({0.3, -1, 2}, {0, 0, 0}, 480, 480, 2)}) {
            EXPECT_LE(holes(draw(*device_, view, cloud, discPasses())), 0.003) << spacing;
            const double half = holes(draw(*device_, view, cloud, discPasses(0.5)));
            EXPECT_GE(half, 0.10) << spacing;
            EXPECT_LE(half, 0.25) << spacing;
            ewa += holes(draw(*device_, view, cloud, ewaPasses()));
            plain += holes(draw(*device_, view, narrow, ewaPasses()));
            ++pictures;
        }
    }
    EXPECT_LE(ewa / pictures, 0.0035);
    EXPECT_GE(plain / pictures, 0.01) << "the oracle sees the difference";
}

// Right because the depth of a plane along a ray is known; the centres' own pixels, which show the centres'
// depth, may be off by the plane's slope over half a pixel's diagonal.
TEST_P(Discs, HaveTheDepthOfTheirPlane) {
    std::vector<AnalyticPoint> points = planeOf(3, 3, 0.05, grey);
    for (AnalyticPoint& p : points) p.surfel = surfelOf({0, 0, 1}, 0.07);
    const AnalyticCloud cloud(points, 0.05);
    for (const Viewpoint& view :
         {lookAt({0, -1.5, 0.8}, {0, 0, 0}, 400, 300, 60), lookAt({0.5, -3, 0.5}, {0, 0, 0}, 640, 200, 30),
          lookAtOrthographic({0, -2, 1}, {0, 0, 0}, 300, 300, 2)}) {
        const Frame frame = draw(*device_, view, cloud, discPasses());
        std::size_t exact = 0, drawn = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                const double d = depth(frame, x, y);
                if (std::isinf(d)) continue;
                const auto depthAt = [&](double px, double py) {
                    const Ray ray = rayThrough(view, px, py);
                    const glm::dvec3 hit = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
                    return -(view.cloudToView * glm::dvec4(hit, 1)).z;
                };
                const double expected = depthAt(x + 0.5, y + 0.5);
                const double slack = std::abs(depthAt(x + 0.5, y) - depthAt(x + 0.5, y + 1)) +
                                     std::abs(depthAt(x, y + 0.5) - depthAt(x + 1, y + 0.5));
                ASSERT_NEAR(d, expected, 0.5 * slack + 1e-4) << x << ", " << y;
                exact += std::abs(d - expected) <= 1e-4 * expected ? 1 : 0;
                ++drawn;
            }
        }
        EXPECT_GT(drawn, frame.depth.size() / 3);
        EXPECT_GT(double(exact) / double(drawn), 0.6) << "all but the centres' own pixels";
    }
}

// Right because whatever wins or is blended has the one colour that there is; means of one value are that
// value, however weights are rounded.
TEST_P(Surfels, ConstantColourInIsExactlyThatColourOut) {
    std::vector<AnalyticPoint> points = sphereOf(9000);
    for (AnalyticPoint& p : points) p.rgb = {13, 201, 97};
    const AnalyticCloud cloud(points, 0.04);
    for (const Viewpoint& view :
         {lookAt({2.5, 0, 0}, {0, 0, 0}, 400, 300), lookAt({0.2, 0.1, 0}, {1, 0, 0}, 300, 300, 100, 0.01),
          lookAtOrthographic({-3, 1, 1}, {0, 0, 0}, 200, 150, 2.5)}) {
        for (const PassList& passes : {discPasses(), ewaPasses(), ewaPasses(0.05), voronoiPasses(false),
                                       voronoiPasses(true), voronoiPasses(true, true)}) {
            const Frame frame = draw(*device_, view, cloud, passes, true);
            for (std::size_t i = 0; i < frame.depth.size(); ++i) {
                const Rgb8 color = pixel(frame, int(i) % frame.width, int(i) / frame.width);
                ASSERT_EQ(color, std::isinf(frame.depth[i]) ? (Rgb8{0, 0, 0}) : (Rgb8{13, 201, 97}));
            }
        }
    }
}

// Right because the sums of two colours in known numbers have a known mean, and 20,000 fragments of full
// weight overflow 32 bits many times.
TEST_P(Surfels, SumsNeverOverflow) {
    std::vector<AnalyticPoint> points(20000);
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i].rgb = i % 4 == 0 ? Rgb8{255, 0, 10} : Rgb8{255, 200, 90};
        points[i].surfel = surfelOf({0, 0, 1}, 1);
    }
    const AnalyticCloud cloud(points, 1);
    const Viewpoint view = lookAt({0, 0, 10}, {0, 0, 0}, 64, 64, 20);
    for (const PassList& passes : {ewaPasses(), voronoiPasses(true)}) {
        const Frame frame = draw(*device_, view, cloud, passes);
        EXPECT_EQ(pixel(frame, 32, 32), (Rgb8{255, 150, 70}));
        EXPECT_EQ(pixel(frame, 30, 34), (Rgb8{255, 150, 70}));
    }
}

// Right because the pictures are compared with nothing but themselves: every depth is a place in front of
// near, every pixel drawn or background.
TEST_P(Surfels, SurviveEveryPlaceOfTheEye) {
    Numbers numbers(72);
    std::vector<AnalyticPoint> points(3000);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere() * numbers.uniform(0, 2);
        const double radius = std::exp2(numbers.uniform(-8, 8));
        p.surfel = surfelOf(numbers.onSphere(), radius, numbers.onSphere(), 0.3);
    }
    for (int i = 0; i < 200; ++i) {  // seen exactly edge-on, and from inside
        AnalyticPoint p;
        p.surfel = surfelOf({0, 0, 1}, 4);
        points.push_back(p);
    }
    const AnalyticCloud cloud(points, 1);
    const std::vector<Viewpoint> views = {lookAt({3, 0, 0}, {0, 0, 0}, 200, 100, 60, 1e-3),
                                          lookAt({0.1, 0, 0}, {1, 0, 0}, 200, 100, 179.9, 1e-30),
                                          lookAt({0.1, 0, 1e-7}, {1, 0, 0}, 200, 100, 0.01, 1e-6),
                                          lookAt({1e6, 0, 0}, {0, 0, 0}, 200, 100, 1e-3),
                                          lookAtOrthographic({0, 0.01, 0}, {0, 1, 0}, 200, 100, 1e-6, 1e-30),
                                          lookAtOrthographic({0, -10, 0}, {0, 1, 0}, 200, 100, 1e9)};
    for (const Viewpoint& view : views) {
        for (PassList passes : {discPasses(), discPasses(100), ewaPasses(0), ewaPasses(4),
                                voronoiPasses(false), voronoiPasses(true, true)}) {
            const Frame frame = draw(*device_, view, cloud, passes, true);
            for (const float d : frame.depth) ASSERT_TRUE(d >= float(view.near) * 0.9999f) << d;
        }
    }
}

// Right because half of a closed surface faces away: culled, the picture is the same; without its front the
// other half shows.
TEST_P(Discs, AreCulledByTheirSideWhereItIsKnown) {
    const AnalyticCloud cloud(sphereOf(20000), 0.03);
    const Viewpoint view = lookAt({3, 1, 0.5}, {0, 0, 0}, 300, 300, 30);
    const auto passes = [](Facing facing) {
        PassList list = discPasses();
        std::get<NearestPass>(list[0]).facing = facing;
        return list;
    };
    const Frame all = draw(*device_, view, cloud, passes(Facing::Any), true);
    const Frame front = draw(*device_, view, cloud, passes(Facing::Front), true);
    const Frame back = draw(*device_, view, cloud, passes(Facing::Back), true);
    const Frame unknown = draw(*device_, view, cloud, passes(Facing::Front), false);
    EXPECT_EQ(unknown.rgba, all.rgba);
    std::size_t different = 0;
    for (std::size_t i = 0; i < all.depth.size(); ++i) different += all.depth[i] != front.depth[i] ? 1 : 0;
    EXPECT_LT(double(different), 0.01 * double(all.depth.size())) << "but for the outline";
    EXPECT_GT(depth(back, 150, 150), depth(front, 150, 150) + 1.8f);
}

}  // namespace
}  // namespace scancast::test
