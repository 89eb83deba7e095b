// Normals of frames whose depth comes in steps: docs/spec/surfels.md §10. Right because each pixel's line of sight meets
// planes and a ball of which is known where they are, before its disparity is rounded to a whole number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "renderer/cloud/surfels/surfels.hpp"
#include "tests/support/clouds/point_sets.hpp"

namespace scancast {
namespace {

using test::Points;
using test::uniform;

std::vector<Surfel> estimate(const Points& points, bool layers) {
    std::vector<Surfel> out(points.size());
    estimateSurfels(points, {.layers = layers}, out);
    return out;
}

double degrees(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), std::abs(glm::dot(a, b))) * 180 / std::numbers::pi;
}

struct Frame {
    Points points;
    std::vector<glm::dvec3> normals;  ///< of the surface that each stands for; 0 near a crease or an outline
};

/// A room's corner with a ball in it, by a camera that looks along +z: wall behind, wall beside, floor.
Frame corner(double stepOfDisparity) {
    const glm::dvec3 ball(-0.5, 0.1, 2.6);
    constexpr double ballRadius = 0.5, focal = 400, crease = 0.1;
    Frame frame;
    for (int v = -180; v < 180; ++v)
        for (int u = -240; u < 240; ++u) {
            const glm::dvec3 ray(u / focal, v / focal, 1);
            // z where it meets z = 3.8 - x/2, x = 1.1 + z/10 and y = 1.
            const glm::dvec3 planes[] = {{0.5, 0, 1}, {1, 0, -0.1}, {0, 1, 0}};
            const double offsets[] = {3.8, 1.1, 1};
            double z = 1e9, next = 1e9;
            glm::dvec3 normal(0);
            for (int i = 0; i < 3; ++i) {
                const double toward = glm::dot(planes[i], ray);
                if (toward <= 0) continue;
                const double at = offsets[i] / toward;
                if (at < z) {
                    next = z;
                    z = at;
                    normal = planes[i];
                } else {
                    next = std::min(next, at);
                }
            }
            for (int i = 0; i < 3; ++i) {
                const double far =
                    std::abs(glm::dot(planes[i], ray * z) - offsets[i]) / glm::length(planes[i]);
                if (planes[i] != normal && far < crease) normal = glm::dvec3(0);
            }
            const double a = glm::dot(ray, ray), b = glm::dot(ray, ball);
            const double beside = std::sqrt(std::max(0.0, glm::dot(ball, ball) - b * b / a));
            if (beside < ballRadius) {
                z = (b - std::sqrt(b * b - a * (glm::dot(ball, ball) - ballRadius * ballRadius))) / a;
                normal = ray * z - ball;
            }
            if (std::abs(beside - ballRadius) < crease) normal = glm::dvec3(0);
            const double seen =
                stepOfDisparity > 0 ? 1 / (std::round(1 / z / stepOfDisparity) * stepOfDisparity) : z;
            frame.points.push_back(glm::vec3(ray * seen));
            frame.normals.push_back(normal);
        }
    return frame;
}

/// Share of those whose normals are known that are within so many degrees.
double share(const Frame& frame, const std::vector<Surfel>& surfels, double within, bool ofBall) {
    double all = 0, good = 0;
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        const glm::dvec3& n = frame.normals[i];
        if (n == glm::dvec3(0) || (n.z < -0.11) != ofBall) continue;
        ++all;
        good += surfels[i].normal != glm::vec3(0) && degrees(surfels[i].normal, n) < within;
    }
    return good / all;
}

TEST(Layers, OfASteppedFrameAreSeenThrough) {
    // 1 / 350 m: steps of 2.6 cm at 3 m, where pixels are 7.5 mm apart.
    const Frame frame = corner(1.0 / 350);
    const auto before = estimate(frame.points, false), after = estimate(frame.points, true);
    EXPECT_LT(share(frame, before, 20, false), 0.4);
    EXPECT_GT(share(frame, after, 10, false), 0.99);
    EXPECT_GT(share(frame, after, 5, false), 0.98);
    for (std::size_t i = 0; i < after.size(); ++i) {
        const Surfel& s = after[i];
        if (s.normal == glm::vec3(0)) continue;
        ASSERT_NEAR(glm::length(s.normal), 1, 1e-4);
        ASSERT_NEAR(glm::dot(s.normal, s.majorAxis), 0, 1e-4);
        ASSERT_EQ(s.radius, before[i].radius);
    }
    EXPECT_LT(share(frame, before, 20, true), 0.4);
    EXPECT_GT(share(frame, after, 20, true), 0.98);
}

/// Whether nothing at all is changed.
void expectUntouched(const Points& points) {
    const auto before = estimate(points, false), after = estimate(points, true);
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(before[i].normal, after[i].normal) << i;
        ASSERT_EQ(before[i].minor, after[i].minor) << i;
        ASSERT_EQ(before[i].density, after[i].density) << i;
    }
}

TEST(Layers, AreNotFoundInWhatHasNone) {
    expectUntouched(corner(0).points);
    // Leaves; the voxels that a ball's surface meets; steps too small to matter; floors and walls.
    Points leaves, voxels, rounded, floors;
    for (std::uint64_t i = 0; i < 30'000; ++i) {
        const glm::vec3 p(uniform(i, 1), uniform(i, 2), uniform(i, 3));
        leaves.push_back(p);
        rounded.push_back({p.x * 10, p.y * 10, std::round(100 * std::sin(p.x * 4) * p.y) / 100});
        const float floor = std::floor(p.z * 20);
        floors.push_back(i % 3 ? glm::vec3(p.x, p.y, floor) : glm::vec3(p.x, std::round(p.y), p.z * 20));
    }
    for (int x = -40; x <= 40; ++x)
        for (int y = -40; y <= 40; ++y)
            for (int z = -40; z <= 40; ++z)
                if (std::abs(glm::length(glm::vec3(x, y, z)) - 38) < 0.5f)
                    voxels.push_back(glm::vec3(x, y, z));
    for (const Points& points : {leaves, voxels, rounded, floors}) expectUntouched(points);
}

// Right because the set of points is the same.
TEST(Layers, DoNotDependOnTheOrder) {
    const Frame frame = corner(1.0 / 350);
    Points backwards(frame.points.rbegin(), frame.points.rend());
    const auto a = estimate(frame.points, true), b = estimate(backwards, true);
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].normal, b[b.size() - 1 - i].normal) << i;
}

}  // namespace
}  // namespace scancast
