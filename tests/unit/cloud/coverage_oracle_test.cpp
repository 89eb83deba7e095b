// Splats as large as a node's spacing close the surface, on every level of the octree, and not by being huge.
#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>
#include <unordered_map>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::SyntheticSource;
using test::uniform;

/// Which balls around samples hold a point; buckets as wide as the largest radius.
class Covering {
  public:
    explicit Covering(double radius) : radius_(radius) {}
    void add(const glm::dvec3& p, double r) { buckets_[key(p)].push_back({p, r}); }
    bool covers(const glm::dvec3& p) const {
        for (int i = 0; i < 27; ++i) {
            const auto it = buckets_.find(key(p + radius_ * glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
            if (it == buckets_.end()) continue;
            for (const auto& [q, r] : it->second)
                if (glm::dot(p - q, p - q) <= r * r) return true;
        }
        return false;
    }

  private:
    std::uint64_t key(const glm::dvec3& p) const {
        const auto k = [&](double v) {
            return std::uint64_t(std::int64_t(std::floor(v / radius_))) & 0x1fffff;
        };
        return k(p.x) | k(p.y) << 21 | k(p.z) << 42;
    }
    double radius_;
    std::unordered_map<std::uint64_t, std::vector<std::pair<glm::dvec3, double>>> buckets_;
};

struct Surface {
    const char* name;
    double area;
    SyntheticSource::Make sample;
    glm::dvec3 (*anyPoint)(std::uint64_t i);
    double holes = 0;  ///< part of the surface that may stay open
};

void PrintTo(const Surface& s, std::ostream* out) {
    *out << s.name;
}

glm::dvec3 onSquare(std::uint64_t i) {
    return {2 + 96 * uniform(i, 21), 2 + 96 * uniform(i, 22), 0};
}
glm::dvec3 onBall(std::uint64_t i) {
    return test::ball(i + 1'000'000'000, 0).position;
}

ScanPoint regular(std::uint64_t i, std::uint64_t n) {
    const auto side = std::uint64_t(std::sqrt(double(n)));
    return {
        .position = {100.0 * double(i % side) / double(side), 100.0 * double(i / side) / double(side), 0}};
}
ScanPoint randomOnSquare(std::uint64_t i, std::uint64_t) {
    return {.position = {100 * uniform(i, 1), 100 * uniform(i, 2), 0}};
}
/// Lines six times as far apart as the points on them.
ScanPoint scanLines(std::uint64_t i, std::uint64_t n) {
    const auto columns = std::uint64_t(std::sqrt(double(n) * 6)), rows = n / columns;
    return {.position = {100 * (double(i % columns) + uniform(i, 3)) / double(columns),
                         100.0 * double(i / columns) / double(rows), 0.003 * uniform(i, 4)}};
}
/// One half has a hundredth of the other's points.
ScanPoint twoDensities(std::uint64_t i, std::uint64_t n) {
    const bool sparse = i % 101 == 100;
    const auto [column, row] = [&] {
        const std::uint64_t number = sparse ? i / 101 : i - i / 101, all = sparse ? n / 101 : n - n / 101;
        const auto columns = std::uint64_t(std::sqrt(double(all) / 2)), rows = all / columns;
        return std::pair((double(number % columns) + 0.5 * uniform(i, 3)) / double(columns),
                         (double(number / columns) + 0.5 * uniform(i, 4)) / double(rows));
    }();
    return {.position = {(sparse ? 50 : 0) + 50 * column, 100 * row, 0}};
}
/// A golden spiral: as regular as a ball can be.
ScanPoint spiral(std::uint64_t i, std::uint64_t n) {
    const double z = 1 - (2 * double(i) + 1) / double(n), r = std::sqrt(1 - z * z),
                 turn = double(i) * 2.399963229728653;
    return {.position = glm::dvec3(r * std::cos(turn), r * std::sin(turn), z) * 10.0};
}

const Surface surfaces[] = {
    {"regular plane", 10'000, regular, onSquare},
    {"random plane", 10'000, randomOnSquare, onSquare, 5e-4},
    {"scan lines", 10'000, scanLines, onSquare},
    {"two densities", 10'000, twoDensities, onSquare, 1e-3},
    {"regular ball", 400 * glm::pi<double>(), spiral, onBall},
    {"random ball", 400 * glm::pi<double>(), test::ball, onBall, 5e-4},
};

class Coverage : public testing::TestWithParam<Surface> {};

// Right because the surface is known: probes on it ask for a sample nearer than its node's spacing. A level
// is all nodes of that depth with the leaves above it: what a view that refines evenly would draw. Randomly
// placed points leave gaps of any size with some probability, hence a few holes in 10,000.
TEST_P(Coverage, EveryLevelClosesTheSurface) {
    const Surface& surface = GetParam();
    SyntheticSource source(200'000, surface.sample, {});
    const auto cloud = test::build(source, 1024);
    ASSERT_TRUE(cloud);
    const Octree& o = cloud->octree;
    int deepest = 0;
    for (const Node& n : o.nodes()) deepest = std::max<int>(deepest, n.level);
    for (int level = 0; level <= deepest; ++level) {
        double widest = 0, splats = 0;
        for (const Node& n : o.nodes())
            if (n.level == level || (n.isLeaf() && n.level < level))
                widest = std::max<double>(widest, n.spacing);
        Covering covering(widest);
        for (const Node& n : o.nodes()) {
            if (n.level != level && !(n.isLeaf() && n.level < level)) continue;
            for (const glm::dvec3& p : test::positions(o, n)) covering.add(p + cloud->origin, n.spacing);
            splats += n.sampleCount * glm::pi<double>() * double(n.spacing) * n.spacing;
        }
        constexpr int probes = 20'000;
        int holes = 0;
        for (int i = 0; i < probes; ++i) holes += !covering.covers(surface.anyPoint(i));
        EXPECT_LE(holes, surface.holes * probes) << "level " << level;
        // A square grid of discs of its own pitch covers π-fold; random points need about ten.
        EXPECT_LE(splats / surface.area, 12) << "level " << level;
        EXPECT_GE(splats / surface.area, 1.5) << "level " << level;
    }
}

// The same with surfels: discs of the radius that is estimated for each sample close the surface on every
// level, across borders of nodes and chunks (averaged radii would leave 67 % open two levels up), and normals
// are the surface's.
TEST_P(Coverage, SurfelsCloseEveryLevelToo) {
    const Surface& surface = GetParam();
    SyntheticSource source(200'000, surface.sample, {});
    const auto built = buildCloud(
        source, {.title = "test", .shape = {.leafPoints = 1024, .chunkPoints = 60'000, .surfels = true}});
    ASSERT_TRUE(built) << built.error().message;
    const Octree& o = (*built)->octree;
    int deepest = 0;
    for (const Node& n : o.nodes()) deepest = std::max<int>(deepest, n.level);
    ASSERT_GE(deepest, 3);
    for (int level = 0; level <= deepest; ++level) {
        std::vector<std::pair<glm::dvec3, Surfel>> discs;
        double widest = 0, splats = 0, outliers = 0, wrong = 0;
        for (const Node& n : o.nodes()) {
            if (n.level != level && !(n.isLeaf() && n.level < level)) continue;
            for (const Sample& s : test::samples(o, n)) {
                outliers += s.logRadius == outlierRadius;
                if (s.logRadius == outlierRadius) continue;
                discs.emplace_back(position(n, s) + (*built)->origin, decodeSurfel(s, n.radiusUnit));
                const glm::dvec3 normal =
                    surface.anyPoint == onBall ? glm::normalize(discs.back().first) : glm::dvec3(0, 0, 1);
                wrong += std::abs(glm::dot(normal, glm::dvec3(discs.back().second.normal))) < 0.97;
                widest = std::max<double>(widest, discs.back().second.radius);
            }
        }
        Covering covering(widest);
        for (const auto& [p, surfel] : discs) {
            covering.add(p, surfel.radius);
            splats += glm::pi<double>() * double(surfel.radius) * surfel.radius;
        }
        constexpr int probes = 20'000;
        int holes = 0;
        for (int i = 0; i < probes; ++i) holes += !covering.covers(surface.anyPoint(i));
        EXPECT_LE(holes, (surface.holes > 0 ? 3e-3 : 0) * probes) << "level " << level;
        EXPECT_LE(splats / surface.area, 14) << "level " << level;
        EXPECT_LE(outliers, 1e-3 * double(discs.size())) << "level " << level;
        EXPECT_LE(wrong, 5e-3 * double(discs.size())) << "level " << level;
    }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Coverage, testing::ValuesIn(surfaces), [](const auto& p) {
    std::string name = p.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

}  // namespace
}  // namespace scancast
