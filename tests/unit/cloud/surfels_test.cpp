// Neighbours, surfels and their degenerate cases.
#include "renderer/cloud/surfels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "renderer/cloud/neighbours.hpp"
#include "tests/support/point_sets.hpp"

namespace scancast {
namespace {

using test::Points;

std::vector<Surfel> estimate(const Points& points, int k = 10) {
    std::vector<Surfel> out(points.size());
    estimateSurfels(points, {k}, out);
    return out;
}

/// Right because it sorts all distances: the k smallest to distinct positions, by definition.
std::vector<float> bruteForce(const Points& distinct, const glm::vec3& at, int k) {
    std::vector<float> squared;
    for (const glm::vec3& p : distinct) {
        const glm::vec3 d = p - at;
        if (p != at) squared.push_back(d.x * d.x + d.y * d.y + d.z * d.z);
    }
    std::sort(squared.begin(), squared.end());
    squared.resize(std::min(squared.size(), std::size_t(k)));
    return squared;
}

struct Case {
    const char* name;
    Points (*make)();
};

class Clouds : public testing::TestWithParam<Case> {};

TEST_P(Clouds, RadiiAreThoseOfTheNearestDistinctPoints) {
    const Points points = GetParam().make();
    const Points distinct = test::distinct(points);
    const auto surfels = estimate(points);
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 500) {
        // Any of the doublings may have been taken; which, the major axis tells.
        bool found = false;
        for (const int k : {10, 20, 40, 80}) {
            const auto nearest = bruteForce(distinct, points[i], k);
            double sum = 0;
            for (const float s : nearest) sum += std::sqrt(s);
            const float radius = nearest.empty() ? 0 : float(sum / double(nearest.size()));
            const float reach = nearest.empty() ? 0 : std::sqrt(nearest.back());
            found = found || (surfels[i].major == reach && surfels[i].radius == radius);
        }
        EXPECT_TRUE(found) << GetParam().name << " " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(All, Clouds,
                         testing::Values(Case{"Random", test::randomCube}, Case{"ScanLines", test::scanLines},
                                         Case{"Clusters", test::clusters},
                                         Case{"Duplicates", test::duplicates}, Case{"Gridded", test::gridded},
                                         Case{"FarOutlier", test::farOutlier}, Case{"Line", test::line},
                                         Case{"Few", test::few}),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace scancast
