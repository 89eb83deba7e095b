// Stations and offsets against brute force: each segment by itself, in long double, by formulas of another kind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "renderer/cloud/export/corridor.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"

namespace scancast {
namespace {

using Real = long double;

struct Found {
    Real station = 0, offset = 0, distance = 0, next = std::numeric_limits<Real>::max();
    bool isBeyond = false;
};

/// The nearest place of the line, by the share of the way along each segment; and how much farther the next segment is.
Found bruteForce(const std::vector<glm::dvec2>& line, const glm::dvec2& p) {
    Found best;
    best.distance = std::numeric_limits<Real>::max();
    Real before = 0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Real ax = line[i].x, ay = line[i].y, bx = line[i + 1].x, by = line[i + 1].y;
        const Real length = std::hypot(bx - ax, by - ay);
        const Real share = ((p.x - ax) * (bx - ax) + (p.y - ay) * (by - ay)) / (length * length);
        const Real held = std::clamp<Real>(share, 0, 1);
        const Real x = ax + held * (bx - ax), y = ay + held * (by - ay);
        const Real distance = std::hypot(p.x - x, p.y - y);
        if (distance < best.distance) {
            const Real left = (bx - ax) * (p.y - ay) - (by - ay) * (p.x - ax);
            best.next = best.distance;
            best.distance = distance;
            best.station = before + held * length;
            best.offset = left > 0 ? -distance : distance;
            best.isBeyond = (i == 0 && share < 0) || (i + 2 == line.size() && share > 1);
        } else {
            best.next = std::min(best.next, distance);
        }
        before += length;
    }
    return best;
}

std::vector<glm::dvec2> someLine(std::uint64_t number, const glm::dvec2& origin) {
    std::vector<glm::dvec2> line;
    for (std::uint64_t c = 0; c < 2 + number % 12; ++c)
        line.push_back(origin + 100.0 * glm::dvec2(test::uniform(number * 100 + c, 1),
                                                   test::uniform(number * 100 + c, 2)));
    return line;
}

TEST(Corridor, StationsAndOffsetsAreThoseOfTheNearestSegment) {
    std::size_t inside = 0, outside = 0;
    for (std::uint64_t number = 0; number < test::sized(100, 20); ++number) {
        const glm::dvec2 origin = number % 2 == 0 ? glm::dvec2(0) : glm::dvec2(389'400, 5'819'700);
        const auto line = someLine(number, origin);
        const double width = 1 + 20 * test::uniform(number, 3);
        const auto corridor = Corridor::create(line, width);
        ASSERT_TRUE(corridor);
        for (std::uint64_t i = 0; i < 500; ++i) {
            const glm::dvec2 p = origin + 140.0 * glm::dvec2(test::uniform(i, 4), test::uniform(i, 5)) - 20.0;
            const Found expected = bruteForce(line, p);
            const auto place = corridor->place(p);
            // What lies on an edge to within rounding may be either.
            if (std::abs(expected.distance - width / 2) < 1e-7) continue;
            ASSERT_EQ(place.has_value(), !expected.isBeyond && expected.distance <= width / 2)
                << number << " " << i;
            (place ? inside : outside) += 1;
            if (!place) continue;
            EXPECT_NEAR(std::abs(place->offset), double(expected.distance), 1e-7);
            if (std::abs(expected.next - expected.distance) < 1e-7) continue;  // two are equally near
            EXPECT_NEAR(place->station, double(expected.station), 1e-6);
            EXPECT_NEAR(place->offset, double(expected.offset), 1e-7);
        }
    }
    EXPECT_GT(inside, test::sized(1000U, 200U));
    EXPECT_GT(outside, test::sized(1000U, 200U));
}

// Whoever asks by a box gets the same as who asks all segments, to the last bit.
TEST(Corridor, SegmentsNearABoxAreEnoughForItsPoints) {
    std::size_t skipped = 0;
    for (std::uint64_t number = 0; number < test::sized(100, 20); ++number) {
        const auto line = someLine(number, {389'400, 5'819'700});
        const auto corridor = Corridor::create(line, 4);
        ASSERT_TRUE(corridor);
        for (std::uint64_t i = 0; i < 100; ++i) {
            const glm::dvec2 low =
                glm::dvec2(389'390, 5'819'690) + 110.0 * glm::dvec2(test::uniform(i, 6), test::uniform(i, 7));
            const glm::dvec2 size = 15.0 * glm::dvec2(test::uniform(i, 8), test::uniform(i, 9));
            const auto segments = corridor->segmentsNear(low, low + size);
            skipped += line.size() - 1 - segments.size();
            for (std::uint64_t q = 0; q < 20; ++q) {
                const glm::dvec2 p =
                    low + size * glm::dvec2(test::uniform(i * 20 + q, 10), test::uniform(i * 20 + q, 11));
                const auto all = corridor->place(p), some = corridor->place(p, segments);
                ASSERT_EQ(all.has_value(), some.has_value());
                if (!all) continue;
                ASSERT_EQ(all->station, some->station);
                ASSERT_EQ(all->offset, some->offset);
            }
        }
    }
    EXPECT_GT(skipped, 1000U);
}

TEST(Corridor, EndsAreSquareAndFoldsAreRound) {
    const auto corridor = Corridor::create({{0, 0}, {10, 0}, {10, 10}}, 2);
    ASSERT_TRUE(corridor);
    EXPECT_EQ(corridor->length(), 20);
    const auto at = [&](double x, double y) { return corridor->place({x, y}); };
    EXPECT_FALSE(at(-0.001, 0));
    EXPECT_FALSE(at(10, 10.001));
    ASSERT_TRUE(at(0, 1) && at(0, -1));
    EXPECT_EQ(at(0, 1)->offset, -1);  // left of who walks to the east
    EXPECT_EQ(at(0, -1)->offset, 1);
    EXPECT_FALSE(at(5, 1.0000001));
    // Outside of the fold: the corner's station, as far as the circle goes.
    ASSERT_TRUE(at(10.6, -0.6));
    EXPECT_EQ(at(10.6, -0.6)->station, 10);
    EXPECT_NEAR(at(10.6, -0.6)->offset, std::hypot(0.6, 0.6), 1e-12);
    EXPECT_FALSE(at(10.8, -0.8));
    // Inside of it two segments are equally near: it is the earlier one's.
    EXPECT_EQ(at(9.5, 0.5)->station, 9.5);
    EXPECT_EQ(at(9.5, 0.5)->offset, -0.5);
    EXPECT_EQ(at(9.6, 0.5)->station, 10.5);
}

TEST(Corridor, WhatIsNoLineIsRefused) {
    EXPECT_FALSE(Corridor::create({{0, 0}}, 1));
    EXPECT_FALSE(Corridor::create({{0, 0}, {0, 0}}, 1));
    EXPECT_FALSE(Corridor::create({{0, 0}, {1, 0}}, 0));
    EXPECT_FALSE(Corridor::create({{0, 0}, {NAN, 0}}, 1));
    EXPECT_EQ(Corridor::create({{0, 0}, {1, 0}, {1, 0}}, 1).error().field, "line");
}

}  // namespace
}  // namespace scancast
