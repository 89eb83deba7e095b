// Shares of cells against areas that are known, and against counting where no formula is.
#include "renderer/measure/plan_raster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocol/measure/vertices.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {
namespace {

double areaOf(const PlanRaster& raster) {
    double area = 0;
    for (std::size_t i = 0; i < raster.cells(); ++i) area += raster.share(i) * raster.cell() * raster.cell();
    return area;
}

std::vector<glm::dvec2> star(int points, double turn) {
    std::vector<glm::dvec2> corners;
    for (int i = 0; i < 2 * points; ++i) {
        const double angle = turn + std::numbers::pi * i / points, radius = i % 2 == 0 ? 10 : 4;
        corners.emplace_back(389400 + radius * std::cos(angle), 5819700 + radius * std::sin(angle));
    }
    return corners;
}

TEST(PlanRaster, CellsOfARectangleAreWhole) {
    const PlanRaster raster({{10, 20}, {13, 20}, {13, 22}, {10, 22}}, 0.5);
    EXPECT_EQ(raster.columns(), 6U);
    EXPECT_EQ(raster.rows(), 4U);
    for (std::size_t i = 0; i < raster.cells(); ++i) EXPECT_EQ(raster.share(i), 1);
    EXPECT_EQ(raster.middle(7), glm::dvec2(10.75, 20.75));
}

TEST(PlanRaster, SharesAddUpToTheArea) {
    for (const double cell : {0.13, 0.7, 3.0, 50.0})
        for (const double turn : {0.0, 0.3, 1.1}) {
            auto corners = star(5, turn);
            for (int order = 0; order < 2; ++order, std::ranges::reverse(corners)) {
                const PlanRaster raster(corners, cell);
                const double area = std::abs(signedArea(corners));
                EXPECT_NEAR(areaOf(raster), area, 1e-5 * area) << cell << " " << turn;
            }
        }
}

// Each share by itself, against how many of a cell's points lie inside.
TEST(PlanRaster, SharesAreThoseOfEachCell) {
    const auto corners = star(4, 0.2);
    const PlanRaster raster(corners, 1.5);
    constexpr int side = 40;
    for (std::size_t i = 0; i < raster.cells(); ++i) {
        int inside = 0;
        for (int k = 0; k < side * side; ++k) {
            const glm::dvec2 at((k % side + 0.5) / side - 0.5, (k / side + 0.5) / side - 0.5);
            const auto cell = raster.cellOf(raster.middle(i) + 1.5 * at);
            if (cell) {
                EXPECT_EQ(*cell, i);
                ++inside;
            }
        }
        EXPECT_NEAR(raster.share(i), double(inside) / (side * side), 0.04) << i;
    }
    EXPECT_FALSE(raster.cellOf({0, 0}));
}

}  // namespace
}  // namespace scancast::test
