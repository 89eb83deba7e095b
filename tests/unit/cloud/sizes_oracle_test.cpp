// How large samples are drawn, on generated scenes of which is known what stands where: no bubble hangs over a
// meadow, round a wire or between the rings of a sweep, on no level of the octree; planes stay closed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/cloud/surfels/sizes.hpp"
#include "renderer/cloud/surfels/surfels.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/point_sets.hpp"

namespace scancast {
namespace {

using test::Points;
using test::ScanPoint;
using test::SyntheticSource;

constexpr float pitch = 0.5f;  ///< of the meadow

/// 160 × 160 shaken points of a meadow.
Points meadow() {
    Points p;
    for (int x = 0; x < 160; ++x)
        for (int y = 0; y < 160; ++y) {
            const glm::vec3 shaken = test::randomPoint(p.size()) * glm::vec3(0.5f, 0.5f, 0.05f);
            p.push_back((glm::vec3(float(x), float(y), 0) + shaken) * pitch);
        }
    return p;
}
/// Leaves of sparse trees: 300 points, 2 to 10 above it.
Points treesOverMeadow() {
    Points p = meadow();
    for (std::size_t i = 0; i < 300; ++i)
        p.push_back(test::randomPoint(i, 5) * glm::vec3(80, 80, 8) + glm::vec3(0, 0, 2));
    return p;
}
/// A wire 6 above it, a point every 0.25.
constexpr float wirePitch = 0.25f;
Points wireOverMeadow() {
    Points p = meadow();
    for (int i = 0; i < 300; ++i)
        p.push_back({2 + float(i) * wirePitch, 40, 6 + 0.01f * test::randomPoint(std::size_t(i), 6).x});
    return p;
}
/// Rings 1 apart, points so far apart on them.
Points rings(float along) {
    Points p;
    for (int ring = 5; ring < 16; ++ring) {
        const auto count = std::size_t(2 * std::numbers::pi * ring / double(along));
        for (std::size_t i = 0; i < count; ++i) {
            const double turn =
                2 * std::numbers::pi * (double(i) + 0.3 * test::uniform(p.size(), 3)) / double(count);
            p.push_back({float(ring * std::cos(turn)), float(ring * std::sin(turn)), 0});
        }
    }
    return p;
}
/// Two groups over the meadow, 400 away from it.
Points groupsFarAway(std::size_t small, std::size_t large) {
    Points p = meadow();
    for (std::size_t i = 0; i < small; ++i) p.push_back(test::randomPoint(i, 4) + glm::vec3(0, 0, 400));
    for (std::size_t i = 0; i < large; ++i) p.push_back(test::randomPoint(i, 2) + glm::vec3(400, 0, 0));
    return p;
}

/// 80 × 80 points of a surface as rough as they are apart: stone, or the noise of photogrammetry.
constexpr int roughSide = 80;
Points roughSurface() {
    Points p;
    for (int x = 0; x < roughSide; ++x)
        for (int y = 0; y < roughSide; ++y)
            p.push_back(glm::vec3(float(x), float(y), 0) +
                        test::randomPoint(p.size(), 7) * glm::vec3(1, 1, 2.2f));
    return p;
}
/// As many points of a bush: a volume.
Points bush() {
    Points p;
    for (std::size_t i = 0; i < roughSide * roughSide; ++i) p.push_back(test::randomPoint(i, 8) * 18.5f);
    return p;
}

std::vector<Surfel> estimated(const Points& points, float spacing) {
    std::vector<Surfel> out(points.size());
    const std::vector<float> spacings(points.size(), spacing);
    estimateSurfels(points, {.neighbours = 10, .spacings = spacings}, out);
    return out;
}

float drawnRadius(const Surfel& s, float spacing) {
    return std::min(s.radius, largestRadius(s, s.density, double(spacing)));
}

double share(std::span<const Surfel> surfels, Density density) {
    return double(std::ranges::count(surfels, density, &Surfel::density)) / double(surfels.size());
}

/// Right because a leaf that is drawn larger than the meadow's own points hides what is beside it.
TEST(Sizes, LeavesOverAMeadowAreSmallAndTheMeadowIsASurface) {
    const Points points = treesOverMeadow();
    const auto surfels = estimated(points, pitch);
    const auto ground = std::span(surfels).first(160 * 160), leaves = std::span(surfels).subspan(160 * 160);
    EXPECT_GT(share(ground, Density::Surface), 0.99);
    EXPECT_EQ(share(ground, Density::Stray), 0);
    EXPECT_LT(share(leaves, Density::Surface), 0.01);
    EXPECT_LT(share(leaves, Density::Stray), 0.1);
    std::size_t bubbles = 0;
    for (const Surfel& s : leaves) bubbles += drawnRadius(s, pitch) > 1.5f * pitch;
    EXPECT_LE(bubbles, 3u);
    for (const Surfel& s : ground) EXPECT_GE(drawnRadius(s, pitch), std::min(s.radius, 1.4f * pitch));
}

/// Part of the surface, seen from above, that circles of the drawn radii leave open.
double openFromAbove(const Points& points, const std::vector<Surfel>& surfels) {
    constexpr int border = 4, probes = 4 * (roughSide - 2 * border);
    int open = 0;
    for (int i = 0; i < probes * probes; ++i) {
        const glm::vec2 probe = float(border) + glm::vec2(float(i % probes), float(i / probes)) / 4.0f;
        bool covered = false;
        // Its points are in order, and nobody is as large as three of their distances.
        for (int x = int(probe.x) - 3; x <= int(probe.x) + 3 && !covered; ++x)
            for (int y = int(probe.y) - 3; y <= int(probe.y) + 3 && !covered; ++y) {
                const auto p = std::size_t(x * roughSide + y);
                covered = glm::length(glm::vec2(points[p]) - probe) <= drawnRadius(surfels[p], 1.5f);
            }
        open += !covered;
    }
    return double(open) / (probes * probes);
}

double meanRough(std::span<const Surfel> surfels) {
    double sum = 0;
    for (const Surfel& s : surfels) sum += double(s.rough);
    return sum / double(surfels.size());
}

// Right because a rough surface has no second layer behind its holes: whoever is in its middle has to reach the next. A bush
// has, so most of its leaves stay small; and what stands at a border has nobody beyond it to reach.
TEST(Sizes, RoughSurfacesAreClosedAndBushesAndBordersLessSo) {
    const Points stone = roughSurface();
    std::vector<Surfel> surfels = estimated(stone, 1.5f);
    ASSERT_GT(share(surfels, Density::Foliage), 0.8) << "else it is not rough, and proves nothing";
    EXPECT_LE(openFromAbove(stone, surfels), 0.001);
    std::vector<Surfel> middle, border;
    for (std::size_t p = 0; p < stone.size(); ++p) {
        if (surfels[p].density != Density::Foliage) continue;
        const auto x = int(p) / roughSide, y = int(p) % roughSide;
        const bool outermost = x == 0 || y == 0 || x == roughSide - 1 || y == roughSide - 1;
        (outermost ? border : middle).push_back(surfels[p]);
    }
    const auto leaves = estimated(bush(), 1.5f);
    ASSERT_GT(share(leaves, Density::Foliage), 0.9);
    EXPECT_GT(meanRough(middle), 0.65);
    EXPECT_LT(meanRough(border), 0.5 * meanRough(middle));
    EXPECT_LT(meanRough(leaves), 0.6 * meanRough(middle));
    for (Surfel& s : surfels) s.rough = 0;
    EXPECT_GE(openFromAbove(stone, surfels), 0.05) << "leaves of these sizes would do";
}

// Right because half the distance between its points closes a wire, and more than all of it is thick.
TEST(Sizes, AWireIsThinAndClosed) {
    const auto surfels = estimated(wireOverMeadow(), pitch);
    const auto wire = std::span(surfels).subspan(160 * 160);
    EXPECT_GT(share(wire, Density::Wire), 0.97);
    for (const Surfel& s : wire) {
        if (s.density != Density::Wire) continue;
        EXPECT_GE(drawnRadius(s, pitch), 0.5f * wirePitch);
        EXPECT_LE(drawnRadius(s, pitch), wirePitch * 1.2f);
    }
    EXPECT_GT(share(std::span(surfels).first(160 * 160), Density::Surface), 0.99);
}

// Right because half of the gap closes it, and more than the gap covers what is not there.
TEST(Sizes, RingsOfASweepAreASurfaceWhereTheyKnowOfEachOtherAndElseRings) {
    const auto known = estimated(rings(0.05f), 1);
    EXPECT_GT(share(known, Density::Surface), 0.9);
    for (const Surfel& s : known) EXPECT_LE(drawnRadius(s, 1), 1);
    const auto unknown = estimated(rings(0.01f), 0.01f);
    EXPECT_GT(share(unknown, Density::Wire), 0.99);
    for (const Surfel& s : unknown) EXPECT_LE(drawnRadius(s, 1), 0.02f);
}

// Right because the small groups are 16 times as far away as they are wide, and the large one is no small one.
TEST(Sizes, SmallGroupsFarAwayAreStraysAndLargeOnesAreNot) {
    for (const std::size_t small : {1, 2, 5, 9, 20, 32}) {
        const auto surfels = estimated(groupsFarAway(small, 200), pitch);
        const auto groups = std::span(surfels).subspan(160 * 160);
        EXPECT_EQ(share(groups.first(small), Density::Stray), 1) << small;
        EXPECT_EQ(share(groups.subspan(small), Density::Stray), 0) << small;
        EXPECT_EQ(share(std::span(surfels).first(160 * 160), Density::Stray), 0) << small;
    }
}

Points scene;  ///< what makeOfScene() hands out
ScanPoint makeOfScene(std::uint64_t i, std::uint64_t) {
    return {.position = scene[i]};
}

/// Calls visit(position, radius over the node's spacing, whether it is hidden) for every sample of a cloud.
template <class Visit>
void buildAndVisit(const Points& points, Visit visit) {
    scene = points;
    SyntheticSource source(points.size(), makeOfScene, {});
    const auto built = buildCloud(source, {.title = "test", .shape = {.leafPoints = 512, .surfels = true}});
    ASSERT_TRUE(built) << built.error().message;
    const Octree& o = (*built)->octree;
    for (const Node& n : o.nodes())
        for (const Sample& s : test::samples(o, n))
            visit(n, position(n, s) + (*built)->origin, decodeSurfel(s, n.radiusUnit));
}

// Right because no level may have what the points below do not: balloons that pop.
TEST(Sizes, AreSmallOnEveryLevelAbove) {
    std::size_t leaves = 0, bubbles = 0, flat = 0, levels = 0;
    buildAndVisit(treesOverMeadow(), [&](const Node& n, const glm::dvec3& p, const Surfel& s) {
        levels = std::max<std::size_t>(levels, n.level);
        if (s.outlier || p.z < 1.5) {
            flat += p.z < 0.2;
            return;
        }
        ++leaves;
        bubbles += s.radius > 1.6 * double(n.radiusUnit);  // in 254 steps
    });
    EXPECT_GE(levels, 3u);
    EXPECT_GT(leaves, 400u);
    EXPECT_GT(flat, 30'000u);
    EXPECT_LE(double(bubbles), 0.002 * double(leaves));
}

TEST(Sizes, WhatIsFarFromEverythingIsHiddenOnEveryLevel) {
    buildAndVisit(groupsFarAway(20, 200), [](const Node&, const glm::dvec3& p, const Surfel& s) {
        EXPECT_EQ(s.outlier, p.z > 300) << p.x << " " << p.y << " " << p.z;
    });
}

}  // namespace
}  // namespace scancast
