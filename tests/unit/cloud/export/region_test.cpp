// Regions against brute force: which points lie in a polygon, computed with whole numbers, and what is said of boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "renderer/cloud/export/region.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"

namespace scancast {
namespace {

using Place = std::array<std::int64_t, 2>;

/// Even-odd over whole numbers, exactly: an edge counts where it crosses the ray to the right, its lower end included and its
/// upper one not; a point on it lies to its right.
bool contains(const std::vector<Place>& corners, const Place& p) {
    bool inside = false;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        Place a = corners[i], b = corners[(i + 1) % corners.size()];
        if (a[1] > b[1]) std::swap(a, b);
        if (p[1] < a[1] || p[1] >= b[1]) continue;
        const std::int64_t turn = (b[0] - a[0]) * (p[1] - a[1]) - (p[0] - a[0]) * (b[1] - a[1]);
        inside = inside != (turn > 0);
    }
    return inside;
}

std::int64_t whole(std::uint64_t i, std::uint64_t stream, std::int64_t most) {
    return std::int64_t(test::uniform(i, stream) * double(most));
}

std::vector<Place> someCorners(std::uint64_t number, std::size_t count, std::int64_t most) {
    std::vector<Place> corners;
    for (std::size_t c = 0; c < count; ++c)
        corners.push_back({whole(number * 1000 + c, 1, most), whole(number * 1000 + c, 2, most)});
    return corners;
}

PlanPolygon polygonOf(const std::vector<Place>& corners) {
    PlanPolygon polygon;
    for (const Place& c : corners) polygon.emplace_back(double(c[0]), double(c[1]));
    return polygon;
}

// Right because whole numbers decide, and doubles have them exactly. Edges whose slope is a whole power of two, or 0, let
// points lie on them exactly, too: a small lattice, where many do, has only such.
TEST(RegionPolygon, HasThePointsThatWholeNumbersSay) {
    for (std::uint64_t number = 0; number < test::sized(60, 10); ++number) {
        const auto corners = someCorners(number, 3 + number % 40, 1'000'000);
        const PolygonTest polygon(polygonOf(corners));
        for (std::uint64_t i = 0; i < test::sized(2'000, 300); ++i) {
            const Place p{whole(i, 3, 1'000'000), whole(i, 4, 1'000'000)};
            ASSERT_EQ(polygon.contains({double(p[0]), double(p[1])}), contains(corners, p))
                << number << " " << p[0] << " " << p[1];
        }
    }
    const std::vector<Place> corners{{0, 0}, {8, 0}, {8, 4}, {12, 8}, {4, 8}, {4, 4}, {0, 4}, {-4, 2}};
    const PolygonTest polygon(polygonOf(corners));
    for (std::int64_t x = -5; x <= 13; ++x)
        for (std::int64_t y = -1; y <= 9; ++y)
            ASSERT_EQ(polygon.contains({double(x), double(y)}), contains(corners, {x, y})) << x << " " << y;
}

// Heights so small that no number of bands fits between them.
TEST(RegionPolygon, MayBeAsFlatAsNumbersCanTell) {
    const PolygonTest polygon(PlanPolygon{{0, 0}, {1, 5e-324}, {2, 0}});
    EXPECT_FALSE(polygon.contains({3, 0}));
    EXPECT_FALSE(polygon.contains({1, 1}));
    EXPECT_EQ(polygon.of({-1, -1}, {3, 1}), Within::Across);
    static_cast<void>(polygon.contains({1, 0}));
}

TEST(RegionPolygon, TwoThatShareAnEdgeHaveEachPointOnce) {
    // A square in triangles around a place inside; points on a lattice that the edges go through, and others.
    for (std::uint64_t number = 0; number < 50; ++number) {
        const glm::dvec2 middle(0.1 + 0.8 * test::uniform(number, 1), 0.1 + 0.8 * test::uniform(number, 2));
        const std::array<glm::dvec2, 4> square{glm::dvec2(0, 0), {1, 0}, {1, 1}, {0, 1}};
        std::vector<PolygonTest> parts;
        for (std::size_t i = 0; i < 4; ++i)
            parts.emplace_back(i % 2 == 0 ? PlanPolygon{square[i], square[(i + 1) % 4], middle}
                                          : PlanPolygon{middle, square[(i + 1) % 4], square[i]});
        const PolygonTest whole(PlanPolygon(square.begin(), square.end()));
        for (std::uint64_t i = 0; i < 500; ++i) {
            const double along = test::uniform(i, 5) * 1.2 - 0.1;
            const glm::dvec2 p = i % 2 == 0 ? square[i % 4] + along * (middle - square[i % 4])
                                            : glm::dvec2(along, test::uniform(i, 6));
            const auto in = std::ranges::count_if(parts, [&](const auto& part) { return part.contains(p); });
            ASSERT_EQ(in, whole.contains(p) ? 1 : 0) << p.x << " " << p.y;
        }
    }
}

// Inside and Outside are promises about every place; that Across is not said of everything is a promise about speed.
TEST(Region, WhatIsSaidOfABoxHoldsForItsPoints) {
    std::size_t inside = 0, outside = 0;
    for (std::uint64_t number = 0; number < test::sized(200, 40); ++number) {
        PointsRegion wanted;
        wanted.polygon = polygonOf(someCorners(number, 3 + number % 9, 100));
        if (number % 2 == 0) wanted.z = {10, 60};
        if (number % 3 == 0) wanted.clip = ClipBox{{10, 0, 5}, {90, 80, 95}};
        if (number % 5 == 0)
            wanted.clips = {TurnedBox{.center = {50, 50, 50}, .size = {90, 60, 80}, .turn = {30, 10, 0}},
                            HalfSpace{.point = {0, 0, 70}, .normal = {0.1, 0, -1}}};
        const RegionTest region(wanted);
        for (std::uint64_t i = 0; i < 100; ++i) {
            const std::uint64_t seed = number * 1000 + i;
            const glm::dvec3 low(test::uniform(seed, 7) * 100, test::uniform(seed, 8) * 100,
                                 test::uniform(seed, 9) * 100);
            const glm::dvec3 high = low + glm::dvec3(1, 1, 1) * (20 * test::uniform(seed, 10));
            const Within said = region.of(low, high);
            inside += said == Within::Inside;
            outside += said == Within::Outside;
            for (std::uint64_t p = 0; p < 12 && said != Within::Across; ++p) {
                const glm::dvec3 share(test::uniform(seed * 16 + p, 11), test::uniform(seed * 16 + p, 12),
                                       test::uniform(seed * 16 + p, 13));
                ASSERT_EQ(region.contains(low + share * (high - low)), said == Within::Inside) << number;
            }
        }
    }
    EXPECT_GT(inside, 50U);
    EXPECT_GT(outside, 500U);
}

// A polygon of many edges is not asked edge by edge. Right because each promise is held against all of them.
TEST(Region, ManyEdgesSayOfABoxWhatEachOfThemSays) {
    constexpr int corners = 700;
    PlanPolygon outline;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * 3.14159265358979 * i / corners;
        const double radius = 40 + (i % 7 == 0 ? 9 : 3) * test::uniform(std::uint64_t(i), 3);
        outline.emplace_back(50 + radius * std::cos(angle), 50 + radius * std::sin(angle));
    }
    outline.insert(outline.begin() + corners / 2,
                   {{0, 50.5}, {0, 49.5}});  // upright, and others almost level
    PointsRegion wanted;
    wanted.polygon = outline;
    const RegionTest region(wanted);
    std::array<int, 3> said{};
    for (std::uint64_t i = 0; i < test::sized(3000, 300); ++i) {
        const glm::dvec2 low(test::uniform(i, 7) * 110 - 5, test::uniform(i, 8) * 110 - 5);
        const glm::dvec2 size =
            glm::dvec2(test::uniform(i, 9), test::uniform(i, 10)) * (i % 9 == 0 ? 60.0 : 4.0);
        const Within within = region.of({low, 0}, {low + size, 1});
        ++said[std::size_t(within)];
        const glm::dvec2 middle = low + 0.5 * size;
        double nearest = 1e9;
        bool cornerInside = false;
        for (std::size_t e = 0; e < outline.size(); ++e) {
            const glm::dvec2 a = outline[e], b = outline[(e + 1) % outline.size()];
            const double t = std::clamp(glm::dot(middle - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
            nearest = std::min(nearest, glm::distance(middle, a + t * (b - a)));
            cornerInside |= a.x > low.x && a.x < low.x + size.x && a.y > low.y && a.y < low.y + size.y;
        }
        if (cornerInside) {
            ASSERT_EQ(within, Within::Across) << i;
        }
        if (nearest > glm::length(size) / 2) {
            ASSERT_EQ(within, region.contains({middle, 0.5}) ? Within::Inside : Within::Outside) << i;
        }
    }
    for (const int times : said) EXPECT_GT(times, 20);
}

TEST(Region, EdgesBelongToItAsIsSaid) {
    PointsRegion wanted;
    wanted.clip = ClipBox{{0, 0, 0}, {2, 2, 2}};
    wanted.z = {1, 2};
    const RegionTest box(wanted);
    EXPECT_TRUE(box.contains({0, 2, 1}));
    EXPECT_TRUE(box.contains({2, 0, 2}));
    EXPECT_FALSE(box.contains({2, 0, 0.999}));
    PointsRegion square;
    square.polygon = PlanPolygon{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    const RegionTest plan(square);
    EXPECT_TRUE(plan.contains({0, 0, -1e9}));
    EXPECT_TRUE(plan.contains({0, 1, 0}));
    EXPECT_FALSE(plan.contains({2, 1, 0}));
    EXPECT_FALSE(plan.contains({1, 2, 0}));
}

}  // namespace
}  // namespace scancast
