// What must hold for every octree, whatever it was built from.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast::test {

inline std::shared_ptr<const Cloud> build(PointSource& source, std::uint32_t leafPoints = 512,
                                          int threads = 0) {
    auto cloud =
        buildCloud(source, {.title = "test", .threads = threads, .shape = {.leafPoints = leafPoints}});
    EXPECT_TRUE(cloud) << cloud.error().message;
    return cloud ? *cloud : nullptr;
}

/// Of a node of this octree.
inline std::vector<Sample> samples(const Octree& octree, const Node& n) {
    const auto run = octree.run(std::uint32_t(&n - octree.nodes().data()));
    EXPECT_TRUE(run) << run.error().message;
    return run ? std::vector<Sample>(run->samples.begin(), run->samples.end()) : std::vector<Sample>();
}

inline std::vector<glm::dvec3> positions(const Octree& octree, const Node& n) {
    std::vector<glm::dvec3> out;
    for (const Sample& s : samples(octree, n)) out.push_back(position(n, s));
    return out;
}

/// Numbering: breadth first, children side by side, runs dense, counts that add up.
inline void checkStructure(const Cloud& cloud, std::uint32_t leafPoints) {
    const Octree& o = cloud.octree;
    ASSERT_FALSE(o.nodes().empty());
    EXPECT_EQ(o.nodes()[0].parent, noNode);
    EXPECT_EQ(o.nodes()[0].points, cloud.points);
    std::uint64_t sample = 0;
    std::uint32_t nextChild = 1;
    for (std::uint32_t i = 0; i < o.nodes().size(); ++i) {
        const Node& n = o.node(i);
        ASSERT_EQ(n.firstSample, sample);
        ASSERT_GT(n.sampleCount, 0u);
        sample += n.sampleCount;
        ASSERT_TRUE(n.spacing > 0 && std::isfinite(n.spacing));
        ASSERT_TRUE(n.step.x > 0 && n.step.y > 0 && n.step.z > 0);
        if (n.isLeaf()) {
            EXPECT_EQ(n.firstChild, noNode);
            EXPECT_EQ(n.sampleCount, n.points);
            EXPECT_TRUE(n.sampleCount <= leafPoints || n.boxMin == n.boxMax);
            continue;
        }
        ASSERT_EQ(n.firstChild, nextChild);
        ASSERT_GE(n.childCount, 2);
        nextChild += n.childCount;
        std::uint64_t points = 0;
        for (std::uint32_t c = n.firstChild; c < nextChild; ++c) {
            const Node& child = o.node(c);
            EXPECT_EQ(child.parent, i);
            EXPECT_EQ(child.level, n.level + 1);
            EXPECT_LE(child.spacing, n.spacing);
            points += child.points;
        }
        EXPECT_EQ(points, n.points);
    }
    EXPECT_EQ(nextChild, o.nodes().size());
    EXPECT_EQ(sample, o.sampleCount());
}

/// Every sample lies in the box and sphere of its node and of all nodes above; boxes are tight.
inline void checkBounds(const Octree& o) {
    std::vector<glm::dvec3> low(o.nodes().size(), glm::dvec3(1e300)),
        high(o.nodes().size(), glm::dvec3(-1e300));
    for (std::uint32_t i = 0; i < o.nodes().size(); ++i)
        for (const glm::dvec3& p : positions(o, o.node(i)))
            for (std::uint32_t up = i; up != noNode; up = o.node(up).parent) {
                const Node& n = o.node(up);
                low[up] = glm::min(low[up], p);
                high[up] = glm::max(high[up], p);
                ASSERT_LE(glm::length(p - n.center), n.radius * (1 + 1e-9)) << "node " << up;
            }
    for (std::uint32_t i = 0; i < o.nodes().size(); ++i) {
        EXPECT_EQ(o.node(i).boxMin, low[i]) << "node " << i;
        EXPECT_EQ(o.node(i).boxMax, high[i]) << "node " << i;
    }
}

/// Leaves hold each input point exactly once, displaced by no more than 0.05 of the leaf's spacing (or what
/// float64 cannot tell apart). Right because it pairs sorted lists, not because it trusts the builder's
/// bookkeeping.
inline void checkEachPointOnce(const Cloud& cloud, std::vector<glm::dvec3> input, double tolerance = -1) {
    struct Found {
        glm::dvec3 at;
        double allowed;
    };
    std::vector<Found> found;
    for (const Node& n : cloud.octree.nodes())
        if (n.isLeaf())
            for (const glm::dvec3& p : positions(cloud.octree, n))
                found.push_back({p + cloud.origin, tolerance >= 0 ? tolerance : 0.05 * n.spacing});
    ASSERT_EQ(found.size(), input.size());
    // Nearest partner by buckets: points are displaced by less than `cell`, so a partner is in the 27 around.
    double cell = 1e-9;
    for (const Found& f : found) cell = std::max(cell, f.allowed * 1.01 + 1e-9 * glm::length(f.at));
    const auto key = [&](const glm::dvec3& p) {
        return std::array<std::int64_t, 3>{std::int64_t(std::floor(p.x / cell)),
                                           std::int64_t(std::floor(p.y / cell)),
                                           std::int64_t(std::floor(p.z / cell))};
    };
    std::vector<std::pair<std::array<std::int64_t, 3>, std::size_t>> index;
    for (std::size_t i = 0; i < input.size(); ++i) index.emplace_back(key(input[i]), i);
    std::sort(index.begin(), index.end());
    std::vector<bool> taken(input.size());
    for (const Found& f : found) {
        double best = 1e300;
        std::size_t partner = input.size();
        const auto k = key(f.at);
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy) {
                const std::array<std::int64_t, 3> from{k[0] + dx, k[1] + dy, k[2] - 1};
                for (auto it = std::lower_bound(index.begin(), index.end(), std::pair(from, std::size_t(0)));
                     it != index.end() && it->first[0] == from[0] && it->first[1] == from[1] &&
                     it->first[2] <= k[2] + 1;
                     ++it) {
                    const double d = glm::length(input[it->second] - f.at);
                    if (!taken[it->second] && d < best) best = d, partner = it->second;
                }
            }
        ASSERT_LT(partner, input.size()) << "no input point near a leaf sample";
        ASSERT_LE(best, f.allowed + 4e-16 * (glm::length(f.at) + glm::length(cloud.origin)));
        taken[partner] = true;
    }
}

}  // namespace scancast::test
