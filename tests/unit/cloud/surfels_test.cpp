// Surfels on shapes whose surface is known, and on degenerate input.
#include "renderer/cloud/surfels/surfels.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "renderer/cloud/surfels/kernels/levels.hpp"
#include "tests/support/clouds/point_sets.hpp"

namespace scancast {
namespace {

using test::Points;

using std::numbers::pi;

std::vector<Surfel> estimate(const Points& points, int k = 10) {
    std::vector<Surfel> out(points.size());
    estimateSurfels(points, {.neighbours = k, .bends = true}, out);
    return out;
}

double degrees(const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 p(a), q(b);
    return std::atan2(glm::length(glm::cross(p, q)), std::abs(glm::dot(p, q))) * 180 / pi;
}

bool same(const Surfel& a, const Surfel& b) {
    return a.normal == b.normal && a.majorAxis == b.majorAxis && a.major == b.major && a.minor == b.minor &&
           a.radius == b.radius && a.outlier == b.outlier && a.bend == b.bend;
}

void expectSound(const std::vector<Surfel>& surfels) {
    for (const Surfel& s : surfels) {
        const float normal = glm::length(s.normal);
        ASSERT_TRUE(normal == 0 || std::abs(normal - 1) < 1e-5f) << normal;
        if (s.radius > 0) {
            ASSERT_NEAR(glm::length(s.majorAxis), 1, 1e-5);
            ASSERT_NEAR(glm::dot(s.majorAxis, s.normal), 0, 1e-5);
            ASSERT_LE(s.radius, s.major * 1.0001f);
            ASSERT_LE(s.minor, s.major);
            ASSERT_GE(s.minor, s.major * 0.2499f);
        }
    }
}

// Right because every point of a plane has the plane's normal.
TEST(Surfels, OfAPlaneHaveItsNormal) {
    const glm::vec3 u = glm::normalize(glm::vec3(1, 2, 3)), v = glm::normalize(glm::cross(u, {1, 0, 0}));
    Points points;
    for (std::uint64_t i = 0; i < 5000; ++i)
        points.push_back(u * float(test::uniform(i, 1)) + v * float(test::uniform(i, 2)));
    const auto surfels = estimate(points);
    expectSound(surfels);
    for (const Surfel& s : surfels) ASSERT_LT(degrees(s.normal, glm::cross(u, v)), 0.05);
}

// Right because on a square grid all are known by hand: 4 neighbours at 1, 4 at √2, and 2 of the 4 at 2.
TEST(Surfels, OfASquareGridHaveTheRadiiThatOneCounts) {
    Points points;
    for (int x = 0; x < 30; ++x)
        for (int y = 0; y < 30; ++y) points.push_back({float(x), float(y), 0});
    const auto surfels = estimate(points);
    const Surfel& middle = surfels[15 * 30 + 15];
    EXPECT_FLOAT_EQ(middle.major, 2);
    EXPECT_NEAR(middle.radius, (4 + 4 * std::sqrt(2.0) + 2 * 2) / 10, 1e-6);
    EXPECT_FLOAT_EQ(std::abs(middle.normal.z), 1);
    EXPECT_FALSE(middle.outlier);
}

// Right because a sphere's normal points away from its centre.
TEST(Surfels, OfASpherePointAwayFromItsCentre) {
    Points points;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const double z = 1 - 2 * (double(i) + 0.5) / 20000, turn = double(i) * pi * (3 - std::sqrt(5.0));
        const double r = std::sqrt(1 - z * z);
        points.push_back({float(r * std::cos(turn)), float(r * std::sin(turn)), float(z)});
    }
    const auto surfels = estimate(points);
    expectSound(surfels);
    for (std::size_t i = 0; i < points.size(); ++i) ASSERT_LT(degrees(surfels[i].normal, points[i]), 1);
}

// Right because five points are summed by hand: λ1 = 8/5 along x, λ2 = 2/5 along y, so b = a √(1/4); and with
// the y of 0.1 the ratio is 1/20, for which a quarter stands.
TEST(Surfels, OfACrossAreTheEllipseThatOneCalculates) {
    for (const float height : {1.0f, 0.1f}) {
        const Surfel s = estimate({{0, 0, 0}, {2, 0, 0}, {-2, 0, 0}, {0, height, 0}, {0, -height, 0}})[0];
        EXPECT_FLOAT_EQ(s.major, 2);
        EXPECT_NEAR(s.minor, height == 1 ? 1 : 0.5, 1e-6);
        EXPECT_NEAR(s.radius, (2 + height) / 2, 1e-6);
        EXPECT_NEAR(std::abs(s.majorAxis.x), 1, 1e-6);
        EXPECT_NEAR(std::abs(s.normal.z), 1, 1e-6);
    }
}

// Right because a cylinder bends across its axis only: the normal points away from the axis.
TEST(Surfels, OfACylinderPointAwayFromItsAxis) {
    Points points;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const double turn = 2 * pi * test::uniform(i, 1);
        points.push_back({float(std::cos(turn)), float(std::sin(turn)), float(6 * test::uniform(i, 2))});
    }
    const auto surfels = estimate(points);
    expectSound(surfels);
    std::size_t good = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        good += degrees(surfels[i].normal, {points[i].x, points[i].y, 0}) < 3;
    EXPECT_GT(double(good), 0.98 * double(points.size()));
}

TEST(Surfels, LookPastTheirOwnScanLine) {
    // Lines 1 apart with points 0.05 apart: only 80 neighbours reach the next line, and see the plane.
    const Points points = test::scanLines();
    const auto surfels = estimate(points);
    expectSound(surfels);
    std::size_t flat = 0;
    for (const Surfel& s : surfels) flat += degrees(s.normal, {0, 0, 1}) < 5;
    EXPECT_GT(double(flat), 0.9 * double(points.size()));
}

TEST(Surfels, OfALineHaveADirectionButNoNormal) {
    for (const Surfel& s : estimate(test::line())) {
        EXPECT_EQ(s.normal, glm::vec3(0));
        EXPECT_LT(degrees(s.majorAxis, {1, 2, -1}), 0.01);
        EXPECT_FLOAT_EQ(s.minor, s.major / 4);
    }
}

TEST(Surfels, OfTooFewPointsSayWhatThereIs) {
    EXPECT_TRUE(estimate({}).empty());
    EXPECT_EQ(estimate({{1, 2, 3}})[0].radius, 0);
    for (const Surfel& s : estimate(Points(1000, glm::vec3(7)))) {
        EXPECT_EQ(s.radius, 0);
        EXPECT_EQ(s.normal, glm::vec3(0));
        EXPECT_FALSE(s.outlier);
    }
    for (const Surfel& s : estimate({{0, 0, 0}, {0, 3, 4}})) {
        EXPECT_EQ(s.radius, 5);
        EXPECT_EQ(s.major, 5);
        EXPECT_EQ(s.normal, glm::vec3(0));
        EXPECT_FALSE(s.outlier);
    }
    for (const Surfel& s : estimate({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}))
        EXPECT_NEAR(std::abs(s.normal.z), 1, 1e-6);
}

TEST(Surfels, ACrowdAtOnePlaceCountsOnce) {
    Points points = test::randomCube();
    const auto alone = estimate(points);
    const std::size_t before = points.size();
    for (int i = 0; i < 100000; ++i) points.push_back(points[std::size_t(i) % 3]);
    const auto crowded = estimate(points);
    for (std::size_t i = 0; i < before; ++i) ASSERT_TRUE(same(alone[i], crowded[i]));
    for (std::size_t i = before; i < points.size(); ++i)
        ASSERT_TRUE(same(crowded[i], alone[(i - before) % 3]));
}

// Right because the definition knows no order.
TEST(Surfels, DoNotDependOnTheOrderOfThePoints) {
    for (const auto make : {test::randomCube, test::scanLines, test::gridded, test::clusters}) {
        const Points points = make();
        Points backwards(points.rbegin(), points.rend());
        const auto forth = estimate(points), back = estimate(backwards);
        for (std::size_t i = 0; i < points.size(); ++i)
            ASSERT_TRUE(same(forth[i], back[points.size() - 1 - i])) << i;
    }
}

TEST(Surfels, AreTheSameOnAnyProcessorAndAnyNumberOfThreads) {
    for (const auto make : {test::randomCube, test::scanLines, test::gridded, test::farOutlier}) {
        const Points points = make();
        const auto expected = estimate(points);
        for (const surfel::SurfelKernels* kernels : availableSurfelKernels())
            for (const std::size_t threads : {1, 3}) {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
                std::vector<Surfel> out(points.size());
                estimateSurfels(points, {.bends = true}, out, *kernels);
                for (std::size_t i = 0; i < points.size(); ++i) ASSERT_TRUE(same(out[i], expected[i])) << i;
            }
    }
}

// Right because a halo as wide as the neighbourhoods of neighbours hides nothing that a surfel is made of.
TEST(Surfels, OfAPartWithAHaloAreThoseOfTheWhole) {
    Points points = test::randomCube();
    const auto inside = [](const glm::vec3& p) { return p.x < 40; };
    const auto whole = estimate(points);
    Points part;
    std::vector<Surfel> expected;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (inside(points[i])) {
            part.push_back(points[i]);
            expected.push_back(whole[i]);
        }
    for (const glm::vec3& p : points)
        if (!inside(p) && p.x < 70) part.push_back(p);
    std::vector<Surfel> out(expected.size());
    estimateSurfels(part, {.bends = true}, out);
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_TRUE(same(out[i], expected[i])) << i;
}

TEST(Surfels, SurviveCoordinatesOfAMillionBesideSpacingsOfAThousandth) {
    Points points = test::farOutlier();
    points.push_back({-1e6f, 1e6f, 1e6f});
    const auto surfels = estimate(points);
    expectSound(surfels);
    EXPECT_TRUE(surfels[surfels.size() - 1].outlier);
    EXPECT_TRUE(surfels[surfels.size() - 2].outlier);
    EXPECT_LT(surfels[0].major, 0.01f);
}

}  // namespace
}  // namespace scancast
