// Blended circles, docs/spec/sprites.md §6: against a sum in double, against a clean colour, and at an edge.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"

namespace scancast::test {
namespace {

class BlendedCircles : public OnDevice {};
SCANCAST_ON_DEVICES(BlendedCircles, "egl");

constexpr int width = 400, height = 300;

PassList blended(float sizePx) {
    NearestPass nearest = sprite(Footprint::Circle, Profile::Flat, sizePx);
    return {nearest, SumPass{static_cast<const Splat&>(nearest)}, ResolvePass{true, false}};
}

Frame draw(Device& device, const Viewpoint& view, const Cut& cut, const PassList& passes) {
    Scene scene(view, cut, sprite(Footprint::Circle, Profile::Flat, 1));
    scene.drawing.passes = passes;
    return mustDraw(device, scene.drawing);
}

/// Both projections of the plane y = 3, facing the viewer; `q` px per unit there.
std::vector<Viewpoint> facingViews(double q) {
    return {
        lookAt({0, 0, 0}, {0, 1, 0}, width, height, 2 * std::atan(height / (2 * q * 3)) * 57.29577951308232),
        lookAtOrthographic({0, 0, 0}, {0, 1, 0}, width, height, height / q)};
}

/// The plane y = 3 in rows with shaken points, `apart` px from each other where q px are a unit.
template <class Color>
std::vector<AnalyticPoint> plane(double apart, double q, double depthNoise, const Color& color) {
    Numbers numbers(5);
    std::vector<AnalyticPoint> points;
    const double step = apart / q;
    const double halfWidth = (width / 2 + 40) / q, halfHeight = (height / 2 + 40) / q;
    for (double x = -halfWidth; x < halfWidth; x += step) {
        for (double z = -halfHeight; z < halfHeight; z += step) {
            AnalyticPoint p;
            p.position = {x + numbers.uniform(-0.4, 0.4) * step,
                          3 + numbers.uniform(-1, 1) * depthNoise * step,
                          z + numbers.uniform(-0.4, 0.4) * step};
            p.rgb = color(p.position, numbers);
            points.push_back(p);
        }
    }
    return points;
}

TEST_P(BlendedCircles, AreTheWeightedMeanOfWhatLiesAtTheSurface) {
    // Right because the same sums, in double, straight from docs/spec/sprites.md §6, give the same colours:
    // on two sheets of which the rear one must add nothing, and a noisy one whose fragments lie within the
    // tolerance.
    constexpr float size = 7;
    for (const Viewpoint& view : facingViews(60)) {
        const auto colored = [](const glm::dvec3&, Numbers& n) { return n.color(); };
        std::vector<AnalyticPoint> points = plane(4, 60, 0.2, colored);
        for (AnalyticPoint& p : plane(5, 60, 0.2, colored)) {
            p.position.y += 2;
            points.push_back(p);
        }
        const AnalyticCloud cloud(points, 0.05, 700);
        const Frame frame = draw(*device_, view, cloud.cut(), blended(size));
        int compared = 0;
        for (int y = 7; y < height; y += 11) {
            for (int x = 3; x < width; x += 7) {
                struct Fragment {
                    double depth, weight, radius;
                    const AnalyticPoint* point;
                };
                std::vector<Fragment> fragments;
                double visible = 1e30;
                bool borderline = false;  // a float may see such a fragment on the other side
                for (const AnalyticPoint& p : points) {
                    const glm::dvec4 v = view.cloudToView * glm::dvec4(p.position, 1);
                    const glm::dvec3 at = view.project(glm::dvec3(v));
                    const double u2 =
                        (std::pow(x + 0.5 - at.x, 2) + std::pow(y + 0.5 - at.y, 2)) / (size * size / 4.0);
                    borderline = borderline || std::abs(u2 - 1) < 1e-3;
                    if (u2 > 1) continue;
                    fragments.push_back({at.z, std::pow(1 - u2, 1.5), size / 2.0 / view.q(at.z), &p});
                    visible = std::min(visible, at.z);
                }
                glm::dvec3 sum(0);
                double weights = 0;
                for (const Fragment& f : fragments) {
                    if (f.depth > visible + 2 * f.radius) continue;
                    sum += f.weight * glm::dvec3(f.point->rgb[0], f.point->rgb[1], f.point->rgb[2]);
                    weights += f.weight;
                }
                if (weights < 0.01 || borderline) continue;
                ++compared;
                const Rgb8 got = pixel(frame, x, y);
                for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], sum[c] / weights, 1.5) << x << ", " << y;
                EXPECT_NEAR(depth(frame, x, y), visible, 1e-4) << x << ", " << y;
            }
        }
        EXPECT_GT(compared, 1000);
    }
}

TEST_P(BlendedCircles, ShowExactlyTheColourThatEverythingHas) {
    // Right because the mean of equal colours is that colour, whatever the weights.
    const Rgb8 color{201, 7, 254};
    for (const Viewpoint& view : facingViews(60)) {
        const AnalyticCloud cloud(plane(3, 60, 0.3, [&](const glm::dvec3&, Numbers&) { return color; }),
                                  0.05);
        const Frame frame = draw(*device_, view, cloud.cut(), blended(8));
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) ASSERT_EQ(pixel(frame, x, y), color) << x << ", " << y;
        }
    }
}

TEST_P(BlendedCircles, DoNotOverflowWhereEverythingLiesOnTopOfEachOther) {
    // Right because half of the points are black and half white: their mean is grey, of 10 and of 100,000.
    const Viewpoint view = lookAt({0, -3, 0}, {0, 0, 0}, 64, 64);
    std::vector<AnalyticPoint> points(100'000);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto v = static_cast<std::uint8_t>(i % 2 == 0 ? 0 : 255);
        points[i].rgb = {v, v, v};
    }
    const AnalyticCloud cloud(points, 0.05);
    const Frame frame = draw(*device_, view, cloud.cut(), blended(9));
    EXPECT_NEAR(pixel(frame, 32, 32)[0], 127.5, 0.6);
    EXPECT_NEAR(pixel(frame, 34, 31)[2], 127.5, 0.6);
}

TEST_P(BlendedCircles, ComeNearerToTheCleanColourOfANoisyPlaneThanParaboloids) {
    // Schütz and Wimmer, "High-Quality Point-Based Rendering Using Fast Single-Pass Interpolation", 2015,
    // §IV, Fig. 6. Right because the colour without noise is known.
    const auto clean = [](double x) { return 110 + 60 * std::sin(x * 1.5); };
    for (const double apart : {2.0, 4.0}) {
        for (const Viewpoint& view : facingViews(60)) {
            const auto noisy = [&](const glm::dvec3& at, Numbers& n) {
                const auto v = static_cast<std::uint8_t>(clean(at.x) + n.uniform(-50, 50));
                return Rgb8{v, v, v};
            };
            const AnalyticCloud cloud(plane(apart, 60, 0.2, noisy), 0.05);
            const float size = static_cast<float>(2.2 * apart);
            const auto error = [&](const PassList& passes) {
                const Frame frame = draw(*device_, view, cloud.cut(), passes);
                double sum = 0;
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x)
                        sum += std::pow(pixel(frame, x, y)[0] - clean((x + 0.5 - width / 2) / 60.0), 2);
                }
                return sum;
            };
            const NearestPass paraboloid = sprite(Footprint::Circle, Profile::Paraboloid, size);
            const double gain = 10 * std::log10(error({paraboloid, ResolvePass{}}) / error(blended(size)));
            EXPECT_GT(gain, 3) << "dB at " << apart << " px";
        }
    }
}

TEST_P(BlendedCircles, KeepAnEdgeWithinHalfASplatOfItsPlace) {
    // docs/spec/sprites.md §7: the rise from 10 to 90 % stays within 0.55 p + 1 px; the edge is where the
    // colours change.
    for (const double apart : {2.0, 3.0, 5.0}) {
        for (const Viewpoint& view : facingViews(60)) {
            const auto halves = [](const glm::dvec3& at, Numbers&) {
                const auto v = static_cast<std::uint8_t>(at.x < 0 ? 0 : 255);
                return Rgb8{v, v, v};
            };
            const double p = 2.2 * apart;
            const AnalyticCloud cloud(plane(apart, 60, 0, halves), 0.05);
            const Frame frame = draw(*device_, view, cloud.cut(), blended(static_cast<float>(p)));
            std::vector<double> mean(width, 0);
            for (int y = 20; y < height - 20; ++y) {
                for (int x = 0; x < width; ++x)
                    mean[static_cast<std::size_t>(x)] += pixel(frame, x, y)[0] / 255.0 / (height - 40);
            }
            const auto crossing = [&](double level) {
                std::size_t x = 0;
                while (mean[x] < level) ++x;
                return double(x) - (mean[x] - level) / std::max(1e-9, mean[x] - mean[x - 1]);
            };
            EXPECT_LE(crossing(0.9) - crossing(0.1), 0.55 * p + 1) << p << " px";
            EXPECT_NEAR(crossing(0.5) + 0.5, width / 2, 0.15 * p + 0.5);
        }
    }
}

}  // namespace
}  // namespace scancast::test
