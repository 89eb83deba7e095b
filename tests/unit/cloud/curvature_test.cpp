// Curvatures of shapes whose curvature is known, and their four bytes: docs/spec/surfels.md §11.
#include "renderer/cloud/curvature.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/cloud/surfels/surfels.hpp"
#include "tests/support/clouds/point_sets.hpp"

namespace scancast {
namespace {

using std::numbers::pi;
using test::Points;

constexpr std::size_t count = 20000;

/// What is known of a point of a shape: its normal, and curvatures relative to that.
struct Truth {
    glm::dvec3 at{0}, normal{0}, direction{0};
    double k1 = 0, k2 = 0;
};
using Shape = Truth (*)(double u, double v);

Truth sphere(double u, double v) {
    const double z = 2 * u - 1, turn = 2 * pi * v, r = std::sqrt(1 - z * z);
    const glm::dvec3 n(r * std::cos(turn), r * std::sin(turn), z);
    return {2.0 * n, n, {}, 0.5, 0.5};
}
/// Of radius 1/2, along z.
Truth cylinder(double u, double v) {
    const double turn = 2 * pi * u;
    const glm::dvec3 n(std::cos(turn), std::sin(turn), 0);
    return {0.5 * n + glm::dvec3(0, 0, 3 * v), n, {-n.y, n.x, 0}, 2, 0};
}
/// Radii 2 and 1/2: 1/r across the ring, cos w / (R + r cos w) along it.
Truth torus(double u, double v) {
    const double turn = 2 * pi * u, w = 2 * pi * v, ring = 2 + 0.5 * std::cos(w);
    const glm::dvec3 out(std::cos(turn), std::sin(turn), 0);
    const glm::dvec3 n = out * std::cos(w) + glm::dvec3(0, 0, std::sin(w));
    const glm::dvec3 across = glm::dvec3(0, 0, std::cos(w)) - out * std::sin(w);
    return {ring * out + glm::dvec3(0, 0, 0.5 * std::sin(w)), n, across, 2, std::cos(w) / ring};
}

/// Shaken rows, so that no neighbourhood is like another.
std::vector<Truth> onShape(Shape shape) {
    std::vector<Truth> out;
    const auto side = std::size_t(std::sqrt(double(count)));
    for (std::size_t i = 0; i < side * side; ++i)
        out.push_back(shape((double(i % side) + 0.5 * test::uniform(i, 1)) / double(side),
                            (double(i / side) + 0.5 * test::uniform(i, 2)) / double(side)));
    return out;
}

std::vector<Surfel> surfelsOf(const Points& points) {
    std::vector<Surfel> out(points.size());
    estimateSurfels(points, {.neighbours = 10, .bends = true}, out);
    return out;
}

/// Half of the points have curvatures within a third of `tolerance` (1 / unit) of the truth, 95 % within it, whatever side their normals
/// point to; and directions within 15° where one curvature is twice the other.
void expectCurvatures(Shape shape, double tolerance) {
    const auto truth = onShape(shape);
    Points points;
    for (const Truth& t : truth) points.emplace_back(t.at);
    const auto surfels = surfelsOf(points);
    std::vector<double> errors;
    std::size_t turned = 0, asked = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const Curvature c = curvatureOf(surfels[i]);
        const double sign = glm::dot(glm::dvec3(surfels[i].normal), truth[i].normal) < 0 ? -1 : 1;
        errors.push_back(std::max(std::abs(sign * c.k1 - truth[i].k1), std::abs(sign * c.k2 - truth[i].k2)));
        if (std::abs(truth[i].k1) < 2 * std::abs(truth[i].k2) || c.direction == glm::vec3(0)) continue;
        ++asked;
        turned += std::abs(glm::dot(glm::dvec3(c.direction), truth[i].direction)) < std::cos(15 * pi / 180);
    }
    std::ranges::sort(errors);
    EXPECT_LT(errors[errors.size() / 2], tolerance / 3);
    EXPECT_LT(errors[errors.size() * 95 / 100], tolerance);
    EXPECT_LE(turned * 20, asked);
}

TEST(Curvature, OfASphereIsOneOverItsRadiusInAllDirections) {
    expectCurvatures(sphere, 0.12);
}

TEST(Curvature, OfACylinderIsOneOverItsRadiusAroundItAndNothingAlong) {
    expectCurvatures(cylinder, 0.3);
}

TEST(Curvature, OfATorusIsTheTextbooks) {
    expectCurvatures(torus, 0.55);
}

// Right because the second derivatives of a quadric are what it is made of.
TEST(Curvature, OfAQuadricIsItsSecondDerivatives) {
    constexpr double a = 0.3, b = -0.2, c = -0.7;
    Points points{{0, 0, 0}};
    for (int i = -7; i <= 7; ++i)
        for (int j = -7; j <= 7; ++j) {
            const double u = 0.01 * (i + 0.5 * (j % 2)), v = 0.0087 * j;
            if (i != 0 || j != 0) points.emplace_back(u, v, 0.5 * (a * u * u + 2 * b * u * v + c * v * v));
        }
    const Surfel s = surfelsOf(points)[0];
    const Curvature k = curvatureOf(s);
    // A surface that rises along its normal is hollow there: -h''.
    const double sign = s.normal.z < 0 ? 1 : -1;
    const double mean = 0.5 * (a + c), apart = std::hypot(0.5 * (a - c), b);
    EXPECT_NEAR(k.k1, sign * (mean - apart), 0.02);
    EXPECT_NEAR(k.k2, sign * (mean + apart), 0.02);
    const double along = a * k.direction.x * k.direction.x + 2 * b * k.direction.x * k.direction.y +
                         c * k.direction.y * k.direction.y;
    EXPECT_NEAR(along, mean - apart, 0.01);
}

// Right because the points' only heights are noise: what it bends is little against how it tilts, and mostly nothing.
TEST(Curvature, OfANoisyPlaneIsNextToNothing) {
    Points points;
    for (int x = 0; x < 120; ++x)
        for (int y = 0; y < 120; ++y) {
            const std::uint64_t i = points.size();
            // Nearly normal: the sum of four.
            double noise = -2;
            for (std::uint64_t s = 3; s < 7; ++s) noise += test::uniform(i, s);
            points.emplace_back(x + 0.5 * test::uniform(i, 1), y + 0.5 * test::uniform(i, 2), 0.3 * noise);
        }
    double tilted = 0, turned = 0;
    std::size_t bent = 0;
    for (const Surfel& s : surfelsOf(points)) {
        const double tilt = std::acos(std::min(1.0, double(std::abs(s.normal.z))));
        const double turn = double(curvatureOf(s).k1) * s.radius;
        tilted += tilt * tilt;
        turned += turn * turn;
        bent += s.bend != glm::vec3(0);
    }
    EXPECT_LT(bent * 10, points.size());
    EXPECT_LT(turned, 0.1 * tilted);
}

TEST(Curvature, IsNothingWhereTooFewPointsOrALineTellNothing) {
    for (const Points& points :
         {Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.2f}, {2, 1, 0}}, test::scanLines()})
        for (const Surfel& s : surfelsOf(points)) {
            ASSERT_TRUE(std::isfinite(s.bend.x) && std::isfinite(s.bend.y) && std::isfinite(s.bend.z));
            if (points.size() < 10) {
                ASSERT_EQ(s.bend, glm::vec3(0));
            }
        }
}

// ---- four bytes

struct Known {
    glm::vec3 normal, direction;
    Curvature curvature;
};

Known known(std::uint64_t i) {
    const auto part = [&](std::uint64_t s) { return float(2 * test::uniform(i, s) - 1); };
    glm::vec3 n = decodeNormal(encodeNormal(glm::normalize(glm::vec3(part(1), part(2), part(3)))));
    const glm::vec3 direction = glm::normalize(glm::cross(n, glm::vec3(part(4), part(5), part(6))));
    float k1 = std::exp2(part(7) * 3 - 2), k2 = k1 * part(8);
    if (part(9) < 0) k1 = -k1;
    return {n, direction, {k1, k2, direction}};
}

TEST(CurvatureCode, KeepsCurvaturesToFivePercentAndDirectionsToThreeDegrees) {
    constexpr float unit = 0.37f;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const auto [n, direction, c] = known(i);
        const CurvatureCode code = encodeCurvature(c, n, n, 0.3f, unit);
        const Curvature back = decodeCurvature(code, n, unit);
        ASSERT_NEAR(back.k1, c.k1, 0.046 * std::abs(c.k1));
        ASSERT_NEAR(back.k2, c.k2, std::max(0.046 * std::abs(c.k2), 0.0011 / unit));
        ASSERT_EQ(code >> 24, 0u);
        if (back.k1 != back.k2) {
            ASSERT_GT(std::abs(glm::dot(back.direction, direction)), std::cos(2.9 * pi / 180));
        }
    }
}

TEST(CurvatureCode, CountsFromTheSamplesOwnSideAndTurnsOver) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const auto [n, direction, c] = known(i);
        const glm::vec3 other = decodeNormal(encodeNormal(-n));
        const Curvature front = decodeCurvature(encodeCurvature(c, n, n, 0.3f, 1), n, 1);
        const Curvature behind = decodeCurvature(encodeCurvature(c, n, other, 0.3f, 1), other, 1);
        ASSERT_EQ(behind.k1, -front.k1);
        ASSERT_EQ(behind.k2, -front.k2);
        const CurvatureCode turned = turnedOver(encodeCurvature(c, n, n, 0.3f, 1), n, other);
        const Curvature t = decodeCurvature(turned, other, 1);
        ASSERT_EQ(t.k1, -front.k1);
        ASSERT_EQ(t.k2, -front.k2);
        if (front.k1 != front.k2) {
            ASSERT_GT(std::abs(glm::dot(t.direction, front.direction)), std::cos(4 * pi / 180));
        }
    }
}

// Right because a splat of radius r with more curvature than 1 / r has turned by more than a radian at its border.
TEST(CurvatureCode, NoCurvatureIsMoreThanItsSplatSees) {
    const glm::vec3 n(0, 0, 1);
    const Curvature sharp{50, -20, {1, 0, 0}};
    const Curvature bounded = decodeCurvature(encodeCurvature(sharp, n, n, 0.5f, 0.4f), n, 0.4f);
    EXPECT_NEAR(bounded.k1, 2, 0.1);
    EXPECT_NEAR(bounded.k2, -2, 0.1);
    EXPECT_EQ(encodeCurvature({1e-6f, 0, {1, 0, 0}}, n, n, 0.5f, 0.4f), 0u);
    EXPECT_EQ(encodeCurvature(sharp, n, glm::vec3(0), 0.5f, 0.4f), 0u) << "no normal to count from";
}

TEST(CurvatureCode, AnyBytesAreSomeCurvature) {
    for (std::uint64_t i = 0; i < 5000; ++i) {
        const auto code = CurvatureCode(i * 2654435761u);
        const Curvature c = decodeCurvature(code, known(i % 50).normal, 1);
        ASSERT_LE(std::abs(c.k1), 4.001f);
        ASSERT_LE(std::abs(c.k2), 4.001f);
        ASSERT_TRUE(c.direction == glm::vec3(0) || std::abs(glm::length(c.direction) - 1) < 1e-4f);
    }
}

TEST(CurvatureCode, WiresFoliageAndStraysHaveNone) {
    Surfel s;
    s.normal = {0, 0, 1};
    s.majorAxis = {1, 0, 0};
    s.major = s.minor = s.radius = 1;
    s.bend = {0.5f, 0, 0.25f};
    Sample sample{};
    encodeSurfel(s, 1, sample);
    for (const Density density :
         {Density::Surface, Density::Edge, Density::Wire, Density::Foliage, Density::Stray}) {
        s.density = density;
        EXPECT_EQ(curvatureCodeOf(s, sample, 1) != 0,
                  density == Density::Surface || density == Density::Edge);
    }
}

}  // namespace
}  // namespace scancast
