// Surfels' neighbours and outliers against brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "renderer/cloud/surfels/kernels/levels.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"
#include "renderer/cloud/surfels/surfels.hpp"
#include "tests/support/clouds/point_sets.hpp"

namespace scancast {
namespace {

using test::Points;

struct Near {
    float squared;
    std::size_t point;
};

/// Right because it sorts the distances to all distinct positions: the first k are the k nearest, by
/// definition.
std::vector<Near> bruteForce(const Points& distinct, const glm::vec3& at, std::size_t k) {
    std::vector<Near> near;
    for (std::size_t i = 0; i < distinct.size(); ++i) {
        const glm::vec3 d = distinct[i] - at;
        if (distinct[i] != at) near.push_back({d.x * d.x + d.y * d.y + d.z * d.z, i});
    }
    // Of equally far ones the first by position, and `distinct` is in that order.
    std::stable_sort(near.begin(), near.end(),
                     [](const Near& a, const Near& b) { return a.squared < b.squared; });
    near.resize(std::min(near.size(), k));
    return near;
}

float averageDistance(const std::vector<Near>& near) {
    double sum = 0;
    for (const Near& n : near) sum += std::sqrt(n.squared);
    return near.empty() ? 0 : float(sum / double(near.size()));
}

struct Case {
    const char* name;
    Points (*make)();
};

class Clouds : public testing::TestWithParam<Case> {
  protected:
    Points points_ = GetParam().make();
    Points distinct_ = test::distinct(points_);
};

TEST_P(Clouds, NearestAreFoundExactlyInOrderByEveryLevel) {
    const NeighbourIndex index(points_);
    ASSERT_EQ(index.size(), distinct_.size());
    surfel::SearchScratch workspace{};
    for (const surfel::SurfelKernels* kernels : availableSurfelKernels())
        for (std::uint32_t p = 0; p < index.size(); p += 1 + index.size() / 200) {
            const auto expected = bruteForce(distinct_, index.position(p), 20);
            ASSERT_EQ(kernels->nearest(index.view(), p, 20, workspace), int(expected.size()));
            for (std::size_t j = 0; j < expected.size(); ++j) {
                EXPECT_EQ(workspace.bestSquared[j + 1], expected[j].squared);
                EXPECT_EQ(index.position(workspace.best[j + 1]), distinct_[expected[j].point]);
            }
        }
}

TEST_P(Clouds, RadiiAndReachAreThoseOfTheNearest) {
    std::vector<Surfel> surfels(points_.size());
    estimateSurfels(points_, {}, surfels);
    for (std::size_t i = 0; i < points_.size(); i += 1 + points_.size() / 400) {
        bool found = false;  // by one of the doublings
        for (const std::size_t k : {10, 20, 40, 80}) {
            const auto near = bruteForce(distinct_, points_[i], k);
            const float reach = near.empty() ? 0 : std::sqrt(near.back().squared);
            found = found || (surfels[i].major == reach && surfels[i].radius == averageDistance(near));
        }
        EXPECT_TRUE(found) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Neighbours, Clouds,
                         testing::Values(Case{"Random", test::randomCube}, Case{"ScanLines", test::scanLines},
                                         Case{"Clusters", test::clusters},
                                         Case{"Duplicates", test::duplicates}, Case{"Gridded", test::gridded},
                                         Case{"FarOutlier", test::farOutlier}, Case{"Line", test::line},
                                         Case{"Few", test::few}),
                         [](const auto& p) { return p.param.name; });

/// A plane of 2,500 points, single ones at all heights above it, and far away groups of 1 to 40.
Points strays() {
    Points p;
    for (std::size_t i = 0; i < 2500; ++i) p.push_back(test::randomPoint(i) * glm::vec3(50, 50, 0.1f));
    for (std::size_t i = 0; i < 30; ++i) p.push_back(test::randomPoint(i, 9) * glm::vec3(50, 50, 60));
    for (std::size_t group = 1; group <= 40; group += 3) {
        const glm::vec3 at = test::randomPoint(group, 8) * 2000.0f - 1000.0f;
        for (std::size_t i = 0; i < group; ++i) p.push_back(at + test::randomPoint(i + 100 * group, 7));
    }
    return p;
}

/// The rule, word for word (docs/spec/surfels.md §8), on neighbours by brute force.
bool isStray(const Points& distinct, const std::vector<float>& radii, std::size_t point) {
    const auto near = bruteForce(distinct, distinct[point], 40);
    float width = 0;
    for (std::size_t g = 1; g <= std::min<std::size_t>(near.size(), 32); ++g) {
        const float gap = std::sqrt(near[g - 1].squared);
        std::vector<float> next;
        for (std::size_t i = g - 1; i < std::min(near.size(), g + 7); ++i)
            next.push_back(radii[near[i].point]);
        std::sort(next.begin(), next.end());
        if (gap > 16 * width && gap > 16 * next[(next.size() - 1) / 2]) return true;
        width = gap;
    }
    return false;
}

TEST(Outliers, AreThoseThatAreFarFromEverythingAloneOrInSmallGroups) {
    // Right because it asks every point, where the search has only some under suspicion.
    for (const auto make : {strays, test::clusters, test::farOutlier, test::line}) {
        const Points points = test::distinct(make());
        std::vector<Surfel> surfels(points.size());
        estimateSurfels(points, {}, surfels);
        std::vector<float> radii;
        for (const Surfel& s : surfels) radii.push_back(s.radius);
        std::size_t outliers = 0;
        const bool all = make == strays;
        for (std::size_t i = all ? 0 : points.size() % 17; i < points.size(); i += all ? 1 : 17) {
            EXPECT_EQ(surfels[i].outlier, isStray(points, radii, i)) << i;
            EXPECT_EQ(surfels[i].outlier, surfels[i].density == Density::Stray) << i;
            outliers += surfels[i].outlier;
        }
        EXPECT_GE(outliers, all ? 140u : 0u);
        EXPECT_LE(outliers, make == test::line ? 0u : points.size() / 10);
    }
}

}  // namespace
}  // namespace scancast
