// What a sum adds is of the surface that is visible, and all of that: docs/spec/surfels.md §4.3, docs/spec/passes.md §2.2.
#include <gtest/gtest.h>

#include "tests/oracle/device/surfel_scenes.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

class VisibleSurface : public OnDevice {};
SCANCAST_ON_DEVICES(VisibleSurface, "egl");

constexpr Rgb8 red{255, 0, 0}, blue{0, 0, 255};

/// A blue table, z = 0, which goes on under what stands on it.
std::vector<AnalyticPoint> table(double spacing) {
    std::vector<AnalyticPoint> points = planeOf(3, 3, spacing, [](double, double) { return blue; });
    for (AnalyticPoint& p : points) p.surfel = surfelOf({0, 0, 1}, 1.27 * spacing);
    return points;
}

/// A red ball of radius 1/2 whose lowest point is at this height.
std::vector<AnalyticPoint> ball(int count, double height) {
    std::vector<AnalyticPoint> points = sphereOf(count);
    for (AnalyticPoint& p : points) {
        p.position = p.position * 0.5 + glm::dvec3(0, 0, 0.5 + height);
        p.surfel->radius *= 0.5f;
        p.surfel->major *= 0.5f;
        p.surfel->minor *= 0.5f;
        p.rgb = red;
    }
    return points;
}

bool meetsBall(const Ray& ray, double height) {
    const glm::dvec3 middle = glm::dvec3(0, 0, 0.5 + height) - ray.origin;
    const double along = glm::dot(middle, ray.direction);
    return glm::dot(middle, middle) - along * along < 0.25;
}

/// Whether the ball covers everything within so many px.
bool deepInside(const Viewpoint& view, int x, int y, double px, double height) {
    for (int i = 0; i < 8; ++i) {
        const double angle = i * 0.785398163397448;
        if (!meetsBall(rayThrough(view, x + 0.5 + px * std::cos(angle), y + 0.5 + px * std::sin(angle)),
                       height))
            return false;
    }
    return true;
}

Viewpoint fromElevation(double degrees, double fov) {
    const double a = degrees / 57.29577951308232;
    return lookAt({0, -4 * std::cos(a), 0.5 + 4 * std::sin(a)}, {0, 0, 0.5}, 240, 180, fov);
}

// Right because red is in front of blue there, and both are opaque: 1/16 of blue is what the eye takes for none.
TEST_P(VisibleSurface, HidesTheTableItStandsOn) {
    for (const double height : {0.0, 0.2}) {
        std::vector<AnalyticPoint> points = table(0.03);
        for (const AnalyticPoint& p : ball(4000, height)) points.push_back(p);
        const AnalyticCloud cloud(points, 0.03);
        for (const double lowPass : {0.0, 0.5, 2.0, 4.0}) {
            for (const double elevation : {8.0, 20.0, 45.0, 75.0}) {
                const Viewpoint view = fromElevation(elevation, 22);
                for (const bool oriented : {true, false}) {
                    // Where it touches, its underside and the table are a wedge seen edge-on: only sides tell them apart.
                    if (!oriented && height == 0) continue;
                    const Frame frame = draw(*device_, view, cloud, ewaPasses(lowPass), oriented);
                    std::size_t inside = 0, shining = 0, most = 0;
                    for (int y = 0; y < frame.height; ++y) {
                        for (int x = 0; x < frame.width; ++x) {
                            if (!deepInside(view, x, y, 2, height)) continue;
                            ++inside;
                            shining += pixel(frame, x, y)[2] > 16 ? 1 : 0;
                            most = std::max<std::size_t>(most, pixel(frame, x, y)[2]);
                        }
                    }
                    EXPECT_GT(inside, 5000u);
                    EXPECT_EQ(shining, 0u)
                        << "of " << inside << ", most " << most << ": height " << height << ", low-pass "
                        << lowPass << ", elevation " << elevation << ", oriented " << oriented;
                }
            }
        }
    }
}

// Right because the plane is grey, and what its points differ by is noise: the more of it is blended, the less is left. A
// tolerance along the ray alone leaves one fragment in twenty, and 8 dB.
TEST_P(VisibleSurface, IsBlendedOnAGrazingPlaneWithNoisyNormals) {
    constexpr double spacing = 0.03;
    Numbers numbers(71);
    std::vector<AnalyticPoint> points = planeOf(4, 8, spacing, [&](double, double) {
        const auto grey = static_cast<std::uint8_t>(numbers.uniform(0, 1) < 0.5 ? 0 : 255);
        return Rgb8{grey, grey, grey};
    });
    for (AnalyticPoint& p : points)
        p.surfel = surfelOf(glm::dvec3(0, 0, 1) + 0.12 * numbers.onSphere(), 1.27 * spacing);
    const AnalyticCloud cloud(points, spacing);
    for (const double height : {0.8, 1.6}) {
        const Viewpoint view = lookAt({0, -7, height}, {0, 0, 0}, 240, 60, 12);
        const Frame frame = draw(*device_, view, cloud, ewaPasses());
        double error = 0;
        std::size_t count = 0, holes = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                const Ray ray = rayThrough(view, x + 0.5, y + 0.5);
                const glm::dvec3 hit = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
                if (ray.direction.z >= 0 || std::abs(hit.x) > 3.5 || std::abs(hit.y) > 7) continue;
                ++count;
                holes += std::isinf(depth(frame, x, y)) ? 1 : 0;
                error += std::pow(pixel(frame, x, y)[0] - 127.5, 2);
            }
        }
        EXPECT_GT(count, 3000u);
        EXPECT_EQ(holes, 0u);
        const double psnr = 10 * std::log10(255 * 255 / (error / double(count)));
        EXPECT_GE(psnr, 17) << "height " << height;
    }
}

PassList lit(const char* name) {
    const Method& method = *findMethod(name);
    const ParameterValues values = resolveParameters(method, {}).value();
    return method.passes({method, values, Shading::Phong});
}

// Right because the light is two-sided: which way normals point must not be seen, up to the rim, where half of them turn
// this way and half that.
TEST_P(VisibleSurface, IsLitAlikeWhicheverWayNormalsPoint) {
    std::vector<AnalyticPoint> points = ball(20'000, 0);
    for (AnalyticPoint& p : points) p.rgb = {200, 180, 140};
    const AnalyticCloud oriented(points, 0.015);
    Numbers numbers(72);
    for (AnalyticPoint& p : points) {
        if (numbers.uniform(0, 1) < 0.5) p.surfel->normal = -p.surfel->normal;
    }
    const AnalyticCloud unoriented(points, 0.015);
    for (const char* name : {"ewa", "hqs", "voronoi"}) {
        const Viewpoint view = lookAt({1, -4, 1.5}, {0, 0, 0.5}, 400, 300, 17);
        const Frame truth = draw(*device_, view, oriented, lit(name), true);
        const Frame frame = draw(*device_, view, unoriented, lit(name));
        double error = 0;
        std::size_t count = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                if (!meetsBall(rayThrough(view, x + 0.5, y + 0.5), 0)) continue;
                ++count;
                for (std::size_t c = 0; c < 3; ++c)
                    error += std::pow(double(pixel(frame, x, y)[c]) - pixel(truth, x, y)[c], 2);
            }
        }
        EXPECT_GT(count, 10000u);
        const double psnr = 10 * std::log10(255 * 255 / (error / double(3 * count)));
        EXPECT_GE(psnr, 45) << name;
    }
}

}  // namespace
}  // namespace scancast::test
