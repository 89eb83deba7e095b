// Inner nodes against brute force: the points below a node, gathered from its leaves, put into cells one by
// one.
#include <gtest/gtest.h>

#include <map>

#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::SyntheticSource;
using test::uniform;

constexpr double gridStep = 0.001;

struct Gathered {
    std::array<std::int64_t, 3> at;
    Sample sample;
    int infrared = 0;
};

/// Of a node's samples; 0 where nothing stands beside them.
std::vector<int> infrared(const Octree& octree, std::uint32_t node) {
    const auto run = octree.run(node);
    EXPECT_TRUE(run);
    std::vector<int> values(run->samples.size());
    for (std::size_t i = 0; i < run->beside.size(); ++i) values[i] = nearInfraredIn(run->beside[i]);
    return values;
}

/// The points below a node as integers on the file's grid, counted from the cloud's minimum corner.
void gather(const Cloud& cloud, std::uint32_t index, std::vector<Gathered>& out) {
    const Node& n = cloud.octree.node(index);
    if (!n.isLeaf()) {
        for (std::uint32_t c = 0; c < n.childCount; ++c) gather(cloud, n.firstChild + c, out);
        return;
    }
    const std::vector<int> values = infrared(cloud.octree, index);
    const std::vector<Sample> samples = test::samples(cloud.octree, n);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const glm::dvec3 p = (position(n, samples[i]) + cloud.origin - cloud.bounds[0]) / gridStep;
        out.push_back({{std::llround(p.x), std::llround(p.y), std::llround(p.z)}, samples[i], values[i]});
    }
}

struct BruteForce {
    glm::dvec3 sum{0};
    double count = 0, r = 0, g = 0, b = 0, intensity = 0, infrared = 0;
    std::map<int, int> classes;
};

using Cells = std::map<std::array<std::int64_t, 3>, BruteForce>;

Cells intoCells(const std::vector<Gathered>& points, int cellLevel) {
    Cells cells;
    for (const Gathered& p : points) {
        BruteForce& c = cells[{p.at[0] >> cellLevel, p.at[1] >> cellLevel, p.at[2] >> cellLevel}];
        c.sum += glm::dvec3(p.at[0], p.at[1], p.at[2]);
        c.count += 1;
        c.r += p.sample.r, c.g += p.sample.g, c.b += p.sample.b;
        c.intensity += p.sample.intensity;
        c.infrared += p.infrared;
        ++c.classes[p.sample.classification];
    }
    return cells;
}

ScanPoint colored(std::uint64_t i, std::uint64_t n) {
    ScanPoint p = test::ground(i, n);
    p.color = {std::uint8_t(255 * uniform(i, 5)), std::uint8_t(255 * uniform(i, 6)), std::uint8_t(i)};
    p.intensity = std::uint16_t(65535 * uniform(i, 7));
    p.classification = std::uint8_t(4 * uniform(i, 8));
    p.nearInfrared = std::uint16_t(65535 * uniform(i, 9));
    return p;
}

int majority(const std::map<int, int>& classes) {  // std::map is ordered: ties go to the smaller
    int best = 0, most = 0;
    for (const auto& [c, count] : classes)
        if (count > most) most = count, best = c;
    return best;
}

// Right because the brute force knows nothing of the hierarchy: every inner sample must be the mean of
// exactly the scan points in its cell, so no point is lost, counted twice, or averaged with the wrong weight
// on the way up.
TEST(Averages, AreTheMeansOfThePointsInTheirCells) {
    SyntheticSource source(60'000, colored,
                           {.color = true, .intensity = true, .classification = true, .nearInfrared = true},
                           gridStep);
    const auto cloud = test::build(source, 1024);
    ASSERT_TRUE(cloud);
    int inner = 0;
    for (std::uint32_t i = 0; i < cloud->octree.nodes().size(); ++i) {
        const Node& n = cloud->octree.node(i);
        if (n.isLeaf()) continue;
        ++inner;
        std::vector<Gathered> points;
        gather(*cloud, i, points);
        ASSERT_EQ(points.size(), n.points);
        int cellLevel = 0;  // the cell size is a power of two; the number of occupied cells tells which
        while (cellLevel < 30 && intoCells(points, cellLevel).size() > n.sampleCount) ++cellLevel;
        const Cells cells = intoCells(points, cellLevel);
        ASSERT_EQ(cells.size(), n.sampleCount);
        EXPECT_GE(double(n.spacing), std::ldexp(gridStep, cellLevel) * 0.999);
        const std::vector<int> values = infrared(cloud->octree, i);
        const std::vector<Sample> samples = test::samples(cloud->octree, n);
        for (std::size_t at = 0; at < samples.size(); ++at) {
            const Sample& s = samples[at];
            const glm::dvec3 p = (position(n, s) + cloud->origin - cloud->bounds[0]) / gridStep;
            // Rounding may carry a mean over its cell's border: look at the neighbours too.
            const glm::dvec3 tolerance = n.step / gridStep * 0.5 + 1e-3;
            bool found = false;
            for (int corner = 0; corner < 8 && !found; ++corner) {
                const glm::dvec3 q =
                    p + tolerance * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
                const auto it = cells.find({std::int64_t(std::floor(q.x)) >> cellLevel,
                                            std::int64_t(std::floor(q.y)) >> cellLevel,
                                            std::int64_t(std::floor(q.z)) >> cellLevel});
                if (it == cells.end()) continue;
                const BruteForce& c = it->second;
                const glm::dvec3 off = glm::abs(c.sum / c.count - p);
                if (off.x > tolerance.x || off.y > tolerance.y || off.z > tolerance.z) continue;
                found = true;
                EXPECT_NEAR(s.r, c.r / c.count, 0.5);
                EXPECT_NEAR(s.g, c.g / c.count, 0.5);
                EXPECT_NEAR(s.b, c.b / c.count, 0.5);
                EXPECT_NEAR(s.intensity, c.intensity / c.count, 0.5);
                EXPECT_NEAR(values[at], c.infrared / c.count, 0.5);
                EXPECT_EQ(s.classification, majority(c.classes));
            }
            ASSERT_TRUE(found) << "node " << i;
        }
    }
    EXPECT_GT(inner, 20);
}

// Right because grey is what an area average of equally many black and white points is; a pick instead of an
// average would stay black or white.
TEST(Averages, AFineCheckerboardTurnsGrey) {
    constexpr int side = 512;
    SyntheticSource source(
        side * side,
        [](std::uint64_t i, std::uint64_t) {
            const auto x = i % side, y = i / side;
            const std::uint8_t v = (x + y) % 2 ? 255 : 0;
            return ScanPoint{.position = {double(x), double(y), 0}, .color = {v, v, v}};
        },
        {.color = true}, 1.0);
    const auto cloud = test::build(source, 2048);
    ASSERT_TRUE(cloud);
    const Node& root = cloud->octree.node(0);
    ASSERT_FALSE(root.isLeaf());
    double sum = 0;
    for (const Sample& s : test::samples(cloud->octree, root)) {
        EXPECT_NEAR(s.r, 127.5, 0.5);  // cells of even sides: exactly half of the points are white
        sum += s.r;
    }
    EXPECT_NEAR(sum / root.sampleCount, 127.5, 0.5);
}

// Right because both sides of a thin wall have normals of their own, and one averaged normal would be
// neither.
TEST(Averages, TwoSidesOfAThinWallStayTwoSamples) {
    SyntheticSource source(
        100'000,
        [](std::uint64_t i, std::uint64_t) {
            const bool front = i % 2;
            const glm::vec3 n = front ? glm::vec3(0, -1, 0) : glm::vec3(0, 1, 0);
            const glm::vec3 noise = 0.2f * glm::vec3(uniform(i, 4) - 0.5, 0, uniform(i, 5) - 0.5);
            return ScanPoint{.position = {10 * uniform(i, 1), 5.01 + (front ? 0 : 0.001), 3 * uniform(i, 2)},
                             .color = {std::uint8_t(front ? 255 : 0), 0, 0},
                             .normal = (n + noise) / std::sqrt(1 + noise.x * noise.x + noise.z * noise.z)};
        },
        {.color = true, .normal = true}, 0.001);
    const auto cloud = test::build(source, 1024);
    ASSERT_TRUE(cloud);
    for (const Node& n : cloud->octree.nodes())
        for (const Sample& s : test::samples(cloud->octree, n)) {
            const glm::vec3 normal = decodeNormal(s.normal);
            ASSERT_GT(std::abs(normal.y), 0.95);
            ASSERT_EQ(s.r, normal.y < 0 ? 255 : 0);
        }
}

}  // namespace
}  // namespace scancast
