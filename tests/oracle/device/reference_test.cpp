// Every sprite against the straightforward renderer in double: two implementations that share no code agree
// only if both follow docs/spec/sprites.md §2 and docs/spec/sprites.md §3. They may differ where rounding
// decides: a pixel centre on a splat's border, equal depths.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/reference_renderer.hpp"

namespace scancast::test {
namespace {

class Reference : public OnDevice {};
SCANCAST_ON_DEVICES(Reference, "egl");

struct Case {
    const char* name;
    NearestPass pass;
};

NearestPass worldSized(Footprint footprint, Profile profile) {
    NearestPass pass = sprite(footprint, profile, 0, 2);
    pass.size.scale = 1.3f;
    pass.size.maxPx = 14;
    return pass;
}

std::vector<Case> cases(bool few) {
    using enum Footprint;
    std::vector<Case> list{{"point", sprite(Pixel, Profile::Flat, 1)}};
    const std::vector<float> all{0.6f, 1.4f, 2.0f, 3.3f, 5.0f, 7.7f, 11.3f, 50.0f}, some{0.6f, 3.3f, 11.3f};
    for (const float px : few ? some : all) {
        list.push_back({"square", sprite(Square, Profile::Flat, px)});
        list.push_back({"circle", sprite(Circle, Profile::Flat, px)});
        list.push_back({"paraboloid", sprite(Circle, Profile::Paraboloid, px)});
        list.push_back({"paraboloid on squares", sprite(Square, Profile::Paraboloid, px, 1.5f)});
        list.push_back({"cone", sprite(Circle, Profile::Cone, px)});
        list.push_back({"cone on squares", sprite(Square, Profile::Cone, px)});
        list.push_back({"sphere", sprite(Circle, Profile::Sphere, px, 1)});
    }
    list.push_back({"square, world size", worldSized(Square, Profile::Flat)});
    list.push_back({"paraboloid, world size", worldSized(Circle, Profile::Paraboloid)});
    list.push_back({"cone, world size", worldSized(Circle, Profile::Cone)});
    list.push_back({"sphere, world size", worldSized(Circle, Profile::Sphere)});
    return list;
}

AnalyticCloud room() {
    Numbers numbers(21);
    std::vector<AnalyticPoint> points(12000);
    for (AnalyticPoint& p : points) {
        // A shell around the eye's surroundings, from very near to far.
        p.position = numbers.onSphere() * numbers.uniform(0.4, 6.0) + glm::dvec3(1, 2, 0.5);
        p.rgb = numbers.color();
    }
    return {points, 0.03, 700};
}

/// Share of pixels whose colour and depth agree.
double agreement(const Frame& frame, const ReferencePicture& reference) {
    std::size_t same = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const ReferenceFragment& r = reference.at(x, y);
            const double d = depth(frame, x, y);
            const bool sameDepth =
                std::isinf(r.order) ? std::isinf(d) : std::abs(d - r.order) <= 1e-4 * r.order;
            same += sameDepth && (std::isinf(r.order) || pixel(frame, x, y) == r.color) ? 1 : 0;
        }
    }
    return double(same) / double(frame.depth.size());
}

void compare(const Viewpoint& view, const Cut& cut, const Case& c, Device& device) {
    Scene scene(view, cut, c.pass);
    const glm::dvec2 jitter{0.31, -0.22};
    scene.drawing.jitter = {&jitter, 1};
    const double share = agreement(mustDraw(device, scene.drawing), referenceNearest(scene.drawing));
    EXPECT_GE(share, 0.999) << c.name << ", " << c.pass.size.sizePx << " px";
}

TEST_P(Reference, EverySpriteInPerspective) {
    const AnalyticCloud cloud = room();
    const Viewpoint view = lookAt({1.2, 1.5, 0.3}, {3, 4, 1}, 317, 203, 75, 0.05);
    for (const Case& c : cases(slow_)) compare(view, cloud.cut(), c, *device_);
}

TEST_P(Reference, EverySpriteInOrthographicProjection) {
    const AnalyticCloud cloud = room();
    const Viewpoint view = lookAtOrthographic({-8, -5, 3}, {1, 2, 0.5}, 317, 203, 9);
    for (const Case& c : cases(slow_)) compare(view, cloud.cut(), c, *device_);
}

// Right because a half-open square of n × n px contains n² pixel centres wherever it lies, also where its
// centre is one.
TEST_P(Reference, SquaresOfWholeSizesHaveTheirArea) {
    const AnalyticPoint white{};
    const AnalyticCloud cloud({&white, 1}, 1);
    const Viewpoint view = lookAtOrthographic({0, -10, 0}, {0, 0, 0}, 65, 65, 65);
    for (int px = 1; px <= 50; ++px) {
        for (const Profile profile : {Profile::Flat, Profile::Paraboloid, Profile::Cone}) {
            const Scene scene(view, cloud.cut(), sprite(Footprint::Square, profile, float(px)));
            const Frame frame = mustDraw(*device_, scene.drawing);
            const auto covered =
                std::count_if(frame.depth.begin(), frame.depth.end(), [](float d) { return !std::isinf(d); });
            EXPECT_EQ(covered, px * px) << px << " px, profile " << int(profile);
        }
    }
}

TEST_P(Reference, ColoursAndFilters) {
    Numbers numbers(22);
    std::vector<AnalyticPoint> points(8000);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere() * 2.0;
        p.rgb = numbers.color();
        p.intensity = static_cast<std::uint16_t>(numbers.next());
        p.classification = static_cast<std::uint8_t>(numbers.next() % 30);
        p.normal = encodeNormal(glm::vec3(numbers.onSphere()));
    }
    const AnalyticCloud cloud(points, 0.05, 900);
    const Viewpoint view = lookAt({4, -3, 1}, {0, 0, 0}, 240, 180);
    Scene scene(view, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 4));
    ColorRule& rule = scene.drawing.color;
    for (std::size_t i = 0; i < 256; ++i)
        rule.ramp[i] = {std::uint8_t(i), std::uint8_t(3 * i), std::uint8_t(255 - i)};
    scene.drawing.view().filter.clip = ClipBox{{-1.5, -1.7, -1.9}, {1.8, 1.1, 1.2}};
    scene.drawing.view().filter.shapes =
        clipRegions(ClipShapes{TurnedBox{{0, 0, 0}, {2, 3, 4}, {30, -20, 10}},
                               TurnedBox{{0, 0, 1}, {5, 1, 2}, {-15, 0, 0}},
                               TurnedBox{{1.2, -1.2, 0.4}, {0.8, 0.9, 1}, {45, 0, 0}, true},
                               HalfSpace{{-1, 0, 0}, {1, 0.2, 0.1}}},
                    {});
    scene.drawing.view().filter.classes.emplace().fill(true);
    for (const std::size_t c : {2u, 5u, 29u}) (*scene.drawing.view().filter.classes)[c] = false;
    using enum ColorSource;
    const std::tuple<ColorSource, double, double> rules[] = {{Rgb, 0, 1},
                                                             {Intensity, 500, 60000},
                                                             {Elevation, -2, 2},
                                                             {Depth, 2, 8},
                                                             {Classification, 0, 1},
                                                             {Normal, 0, 1},
                                                             {Lod, 0, 1},
                                                             {Flat, 0, 1}};
    const auto expectAgreement = [&] {
        EXPECT_GE(agreement(mustDraw(*device_, scene.drawing), referenceNearest(scene.drawing)), 0.999)
            << name(rule.source) << (rule.byIntensity ? " by intensity" : "")
            << (rule.toned ? ", toned" : "");
    };
    for (const auto& [source, low, high] : rules) {
        rule.source = source;
        rule.low = low;
        rule.high = high;
        expectAgreement();
    }
    rule.byIntensity = factors(500, 60000);
    expectAgreement();
    rule.source = Rgb;
    rule.toned = true;
    expectAgreement();
    std::get<NearestPass>(scene.passes[0]).payload = Payload::Sample;
    expectAgreement();
}

TEST_P(Reference, DepthOfAPlane) {
    // Depth is known exactly: the plane y = 3 + x / 2 seen from the origin along +Y has, on the ray through
    // (X, Y) = (px - W/2, H/2 - py) / f, the depth 3 / (1 - X / 2).
    std::vector<AnalyticPoint> points;
    for (int i = -300; i <= 300; ++i) {
        for (int j = -200; j <= 200; ++j) {
            const double x = i * 0.01;
            points.push_back({{x, 3 + x / 2, j * 0.01}});
        }
    }
    const AnalyticCloud cloud(points, 0.01);
    const Viewpoint view = lookAt({0, 0, 0}, {0, 1, 0}, 200, 160, 50);
    Scene scene(view, cloud.cut(), sprite(Footprint::Square, Profile::Flat, 2));
    const Frame frame = mustDraw(*device_, scene.drawing);
    int seen = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            if (std::isinf(depth(frame, x, y))) continue;
            ++seen;
            const double across = (x + 0.5 - 100) / view.pixelsPerUnit;
            // A sample may stand up to 1 px and half a spacing away from the pixel; the plane rises 1 in 2.
            const double slack = 0.5 * (2 / view.q(3) + 0.01);
            ASSERT_NEAR(depth(frame, x, y), 3 / (1 - across / 2), slack);
        }
    }
    EXPECT_GT(seen, frame.width * frame.height * 9 / 10);
}

TEST_P(Reference, ConstantColourInIsExactlyThatColourOut) {
    // Nothing is blended: whatever wins a pixel has the one colour that there is.
    Numbers numbers(23);
    std::vector<AnalyticPoint> points(20000);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere();
        p.rgb = {13, 201, 97};
    }
    const AnalyticCloud cloud(points, 0.03, 2000);
    const Viewpoint view = lookAt({2.5, 0, 0}, {0, 0, 0}, 200, 150);
    for (const Case& c : cases(slow_)) {
        Scene scene(view, cloud.cut(), c.pass);
        const Frame frame = mustDraw(*device_, scene.drawing);
        for (std::size_t i = 0; i < frame.depth.size(); ++i) {
            const Rgb8 color = pixel(frame, int(i) % 200, int(i) / 200);
            ASSERT_EQ(color, std::isinf(frame.depth[i]) ? (Rgb8{0, 0, 0}) : (Rgb8{13, 201, 97})) << c.name;
        }
    }
}

TEST_P(Reference, TheCentresPixelIsAlwaysCoveredAtTheCentresDepth) {
    // Far apart, so that no splat can hide another's centre.
    Numbers numbers(24);
    std::vector<AnalyticPoint> points;
    for (int i = 0; i < 24; ++i) {
        for (int j = 0; j < 18; ++j) points.push_back({{i + numbers.uniform(), 20.0, j + numbers.uniform()}});
    }
    const AnalyticCloud cloud(points, 0.001);
    const Viewpoint view = lookAt({12, 0, 9}, {12, 1, 9}, 640, 480);
    for (const Case& c : cases(slow_)) {
        if (c.pass.size.sizePx > 8) continue;
        Scene scene(view, cloud.cut(), c.pass);
        const Frame frame = mustDraw(*device_, scene.drawing);
        for (const CutRun& run : cloud.cut().runs) {
            for (const Sample& sample : run.samples) {
                const glm::dvec3 p = position(*run.node, sample);
                const double x = 320 + view.q(20) * (p.x - 12), y = 240 - view.q(20) * (p.z - 9);
                if (x < 0 || x >= 640 || y < 0 || y >= 480) continue;
                // All lie at depth 20, so a neighbour's splat cannot change the depth that must be seen.
                ASSERT_NEAR(depth(frame, int(x), int(y)), 20, 1e-4)
                    << c.name << ", " << c.pass.size.sizePx << " px";
            }
        }
    }
}

}  // namespace
}  // namespace scancast::test
