// The nearest point, as trying all of them finds it.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>

#include "renderer/cloud/distance/inner_values.hpp"
#include "renderer/cloud/distance/point_tree.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

using test::uniform;

std::vector<glm::dvec3> cube(std::size_t count, std::uint64_t seed, const glm::dvec3& from = glm::dvec3(0)) {
    std::vector<glm::dvec3> points;
    for (std::size_t i = 0; i < count; ++i)
        points.push_back(from + glm::dvec3(uniform(i, seed), uniform(i, seed + 1), uniform(i, seed + 2)));
    return points;
}

double smallest(const std::vector<glm::dvec3>& points, const glm::dvec3& p) {
    double squared = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& q : points) squared = std::min(squared, squaredLength(q - p));
    return squared;
}

void expectNearest(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec3>& asked) {
    const PointTree tree(points);
    for (const glm::dvec3& p : asked) {
        const double squared = smallest(points, p);
        PointTree::Nearest nearest;
        ASSERT_TRUE(tree.findNearer(p, nearest));
        EXPECT_EQ(nearest.squared, squared);
        EXPECT_EQ(squaredLength(tree.point(nearest.place) - p), squared);
        EXPECT_EQ(points[tree.index(nearest.place)], tree.point(nearest.place));
        PointTree::Nearest bounded{.squared = squared};
        EXPECT_FALSE(tree.findNearer(p, bounded)) << "it is not nearer than itself";
        EXPECT_EQ(bounded.squared, squared);
    }
}

TEST(PointTree, FindsTheNearestOfAnyNumberOfPoints) {
    for (const std::size_t count : {1, 2, 15, 16, 17, 33, 100, 1000, 5000}) {
        auto asked = cube(50, 100 + count);
        for (const glm::dvec3& far : cube(20, 200 + count, {3, -2, 0.5})) asked.push_back(far);
        const auto points = cube(count, count);
        asked.push_back(points.front());
        expectNearest(points, asked);
    }
}

TEST(PointTree, FindsTheNearestWherePointsLieOnEachOtherAndInARow) {
    std::vector<glm::dvec3> same(100, glm::dvec3(1, 2, 3)), row;
    for (int i = 0; i < 500; ++i) row.emplace_back(i % 50, 0, 0);
    const auto asked = cube(50, 7);
    expectNearest(same, asked);
    expectNearest(row, asked);
    expectNearest(row, {{24.5, 0, 0}, {100, 1, 1}, {-3, 0, 0}});
}

TEST(PointTree, FindsTheNearestFarFromTheOrigin) {
    const glm::dvec3 utm(389'400, 5'819'700, 40);
    expectNearest(cube(2000, 1, utm), cube(100, 5, utm));
}

TEST(PointTree, IsTheSameWheneverItIsMade) {
    const auto points = cube(3000, 3);
    const PointTree a(points), b(points);
    for (std::uint32_t i = 0; i < points.size(); ++i) ASSERT_EQ(a.index(i), b.index(i));
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < points.size(); ++i) all.push_back(a.index(i));
    std::ranges::sort(all);
    for (std::uint32_t i = 0; i < points.size(); ++i) ASSERT_EQ(all[i], i) << "each point once";
}

TEST(PointTree, InnerSamplesHaveTheValueOfTheNearestBelowOfEqualsTheFirst) {
    const auto onALattice = [](std::vector<glm::dvec3> points, double cells) {
        for (glm::dvec3& p : points) p = glm::floor(p * cells) / cells;
        return points;
    };
    for (const double cells : {4.0, 1e6}) {  // many equally near, and none
        std::vector<ValuedSamples> below;
        std::vector<glm::dvec3> all;
        std::vector<float> values;
        for (std::uint64_t child = 0; child < 4; ++child) {
            ValuedSamples samples{.places = onALattice(cube(300, 10 * child), cells), .values = {}};
            for (std::size_t i = 0; i < 300; ++i) samples.values.push_back(float(child * 1000 + i));
            all.insert(all.end(), samples.places.begin(), samples.places.end());
            values.insert(values.end(), samples.values.begin(), samples.values.end());
            below.push_back(std::move(samples));
        }
        below.push_back({});
        const auto places = onALattice(cube(200, 99), cells);
        const auto chosen = nearestBelow(places, below);
        ASSERT_EQ(chosen.size(), places.size());
        for (std::size_t i = 0; i < places.size(); ++i) {
            const auto nearest = std::ranges::min_element(
                all, {}, [&](const glm::dvec3& p) { return squaredLength(p - places[i]); });
            EXPECT_EQ(chosen[i], values[std::size_t(nearest - all.begin())]);
        }
    }
}

}  // namespace
}  // namespace scancast
