// Normals with a side, on clouds of which is known what was scanned: docs/spec/surfels.md §9. Right because the
// shapes are formulas: the side of every sample follows from where it lies.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/surfels/patches.hpp"
#include "tests/support/clouds/side_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::uniform;

constexpr Attributes colors{.color = true};

std::shared_ptr<const Cloud> sidedCloud(PointSource& source, int threads = 0,
                                        std::uint32_t chunkPoints = 1 << 20) {
    return buildCloud(
               source,
               {.title = {}, .threads = threads, .shape = {.chunkPoints = chunkPoints, .surfels = true}})
        .value();
}

std::shared_ptr<const Cloud> sidedCloud(std::uint64_t points, const test::SyntheticSource::Make& make,
                                        bool upIsZ = false) {
    test::SyntheticSource source(points, make, colors);
    test::WithoutNormals scan(source, upIsZ);
    return sidedCloud(scan);
}

glm::dvec3 placeOf(const Cloud& cloud, const Node& node, const Sample& sample) {
    return cloud.origin + position(node, sample);
}

/// By a function of the place.
template <class Normal>
test::SideScore score(const Cloud& cloud, bool leaves, Normal normal) {
    return test::scoreSides(cloud, leaves,
                            [&](const Node& node, std::uint32_t, std::size_t, const Sample& s) {
                                return glm::vec3(normal(placeOf(cloud, node, s)));
                            });
}

void expectRight(const test::SideScore& score, double sureAtLeast) {
    EXPECT_GE(score.share(), 0.99);
    EXPECT_GE(score.sureShare(), sureAtLeast);
    EXPECT_LE(score.wrongOfSure(), 0.001);
}

ScanPoint onCube(std::uint64_t i, std::uint64_t) {
    const int face = int(uniform(i, 3) * 6), axis = face / 2;
    glm::dvec3 p(uniform(i, 1) * 2 - 1, uniform(i, 2) * 2 - 1, uniform(i, 4) * 2 - 1);
    p[axis] = face % 2 ? 1 : -1;
    return {.position = p};
}
glm::dvec3 ofCube(const glm::dvec3& p) {
    const glm::dvec3 size = glm::abs(p);
    const double most = std::max({size.x, size.y, size.z});
    glm::dvec3 n(0);
    for (int a = 0; a < 3; ++a)
        if (size[a] > most - 0.02) n[a] = p[a] < 0 ? -1 : 1;
    return n;
}

ScanPoint onTorus(std::uint64_t i, std::uint64_t) {
    const double a = uniform(i, 1) * 6.2831853, b = uniform(i, 2) * 6.2831853, out = 3 + std::cos(b);
    return {.position = {out * std::cos(a), out * std::sin(a), std::sin(b)}};
}
glm::dvec3 ofTorus(const glm::dvec3& p) {
    const glm::dvec3 ring = 3.0 * glm::normalize(glm::dvec3(p.x, p.y, 0));
    return p - ring;
}

TEST(Sides, LinksAreMirrors) {
    const glm::vec3 up(0, 0, 1), east(1, 0, 0);
    EXPECT_FALSE(linkBetween({0, 0, 0}, up, {1, 0, 0}, up).opposite);
    EXPECT_TRUE(linkBetween({0, 0, 0}, up, {1, 0, 0}, -up).opposite);
    EXPECT_GT(linkBetween({0, 0, 0}, up, {1, 0, 0}, up).quality, 0.99f);
    // Across the edge of a box, which is convex, and across its foot, which is not.
    EXPECT_FALSE(linkBetween({-1, 0, 0}, up, {0, 0, -1}, east).opposite);
    EXPECT_FALSE(linkBetween({1, 0, 0}, up, {0, 0, 1}, east).opposite);
    EXPECT_TRUE(linkBetween({-1, 0, 0}, up, {0, 0, 1}, east).opposite);
    // One above the other: two sheets or the noise of one.
    EXPECT_EQ(linkBetween({0, 0, 0}, up, {0, 0, 1}, up).quality, 0);
}

TEST(Sides, ClosedThingsAreSeenFromOutside) {
    const auto points = test::sized(100'000u, 30'000u);
    const auto ball = sidedCloud(points, test::ball);
    expectRight(score(*ball, true, [](const glm::dvec3& p) { return p; }), 0.98);
    expectRight(score(*ball, false, [](const glm::dvec3& p) { return p; }), 0.9);
    expectRight(score(*sidedCloud(points, onCube), true, ofCube), 0.95);
    expectRight(score(*sidedCloud(points, onTorus), true, ofTorus), 0.98);
    EXPECT_EQ(ball->sides->by, KnownSides::By::Neighbours);
    EXPECT_GT(ball->sides->sure, 0.98);
    EXPECT_FALSE(ball->oriented);
}

TEST(Sides, NestedBallsEachHaveOneSide) {
    const auto balls = [](std::uint64_t i, std::uint64_t n) {
        ScanPoint p = test::ball(i, n);
        if (i % 3 == 0) p.position *= 0.6;
        return p;
    };
    const auto cloud = sidedCloud(test::sized(100'000u, 40'000u), balls);
    for (const bool inner : {false, true}) {
        const auto one = score(*cloud, true, [&](const glm::dvec3& p) {
            return (glm::length(p) < 8) == inner ? p : glm::dvec3(0);
        });
        EXPECT_GE(std::max(one.share(), 1 - one.share()), 0.99);
        const double wrong = std::min(one.wrongOfSure(), 1 - one.wrongOfSure());
        EXPECT_LE(one.sure > 0 ? wrong : 0, 0.001);
    }
}

TEST(Sides, ASheetSeenFromBothSidesStaysTwoSided) {
    const auto sheet = [](std::uint64_t i, std::uint64_t) {
        return ScanPoint{.position = {10 * uniform(i, 1), 0.001 * uniform(i, 3), 10 * uniform(i, 2)}};
    };
    for (const bool upIsZ : {false, true}) EXPECT_EQ(sidedCloud(50'000, sheet, upIsZ)->sides->sure, 0);
}

TEST(Sides, TwoSheetsOfAWallLookApart) {
    // A slab whose sides are farther apart than its points: closed, so each looks away from the other.
    const auto slab = [](std::uint64_t i, std::uint64_t n) {
        ScanPoint p = onCube(i, n);
        p.position *= glm::dvec3(5, 0.25, 5);
        return p;
    };
    const auto cloud = sidedCloud(test::sized(200'000u, 100'000u), slab);
    const auto sides = score(*cloud, true, [](const glm::dvec3& p) {
        return std::abs(p.x) < 4.8 && std::abs(p.z) < 4.8 ? glm::dvec3(0, p.y, 0) : glm::dvec3(0);
    });
    EXPECT_GE(sides.share(), 0.99);
    EXPECT_LE(sides.wrongOfSure(), 0.001);
}

TEST(Sides, ADeckOverGroundLooksDownWithItsUnderside) {
    const auto bridge = [](std::uint64_t i, std::uint64_t n) {
        if (i % 2) return ScanPoint{.position = {20 * uniform(i, 1) - 10, 20 * uniform(i, 2) - 10, 0}};
        ScanPoint p = onCube(i, n);
        p.position = p.position * glm::dvec3(3, 8, 0.3) + glm::dvec3(0, 0, 3);
        return p;
    };
    const auto cloud = sidedCloud(test::sized(200'000u, 100'000u), bridge, true);
    const auto faces = [](double z, double side) {
        return [=](const glm::dvec3& p) {
            const bool inside = std::abs(p.x) < 2.7 && std::abs(p.y) < 7.7;
            return inside && std::abs(p.z - z) < 0.05 ? glm::dvec3(0, 0, side) : glm::dvec3(0);
        };
    };
    expectRight(score(*cloud, true, faces(0, 1)), 0.95);
    expectRight(score(*cloud, true, faces(3.3, 1)), 0.95);
    expectRight(score(*cloud, true, faces(2.7, -1)), 0.9);
}

TEST(Sides, GroundLooksUpWhereTheScanSaysWhatIsUp) {
    const auto points = test::sized(100'000u, 30'000u);
    const auto up = [](const glm::dvec3&) { return glm::dvec3(0, 0, 1); };
    const auto known = sidedCloud(points, test::ground, true);
    expectRight(score(*known, true, up), 0.95);
    expectRight(score(*known, false, up), 0.95);
    EXPECT_EQ(sidedCloud(points, test::ground, false)->sides->sure, 0);
}

TEST(Sides, DependOnTheSetOfPointsAlone) {
    const std::uint64_t count = 40'000;
    const auto revision = [&](std::uint64_t step, int threads) {
        test::SyntheticSource source(
            count, [&](std::uint64_t i, std::uint64_t n) { return onTorus(i * step % n, n); }, colors);
        return sidedCloud(source, threads, 6000)->revision;
    };
    const std::string first = revision(1, 1);
    EXPECT_EQ(revision(1, 4), first);
    EXPECT_EQ(revision(7, 3), first);
}

}  // namespace
}  // namespace scancast
