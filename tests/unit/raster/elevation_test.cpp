// Elevations against brute force: every point of the scan is put into its cell by itself.
#include "renderer/raster/elevation.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <map>
#include <optional>

#include "renderer/style.hpp"
#include "tests/unit/raster/raster_clouds.hpp"

namespace scancast::test {
namespace {

class Elevation : public ::testing::Test {
  protected:
    static void SetUpTestSuite() { all_ = new SurveyedCloud(surveyedCloud()); }
    static void TearDownTestSuite() { delete all_; }
    static const Cloud& cloud() { return *all_->cloud; }
    static const std::vector<ScanPoint>& points() { return all_->points; }

    /// All cells, block by block, put together.
    static std::vector<float> cellsOfRaster(const PlannedRaster& raster) {
        const RasterGrid& grid = raster.layout.grid;
        std::vector<float> all(grid.cells());
        for (std::int64_t b = 0; b < grid.blocks(); ++b) {
            const CellWindow block = grid.blockAt(b);
            const auto cells = elevationOf(cloud(), raster.filter, grid, block, raster.elevation);
            EXPECT_TRUE(cells) << cells.error().message;
            EXPECT_EQ(cells->size(), std::size_t(block.cells()));
            for (std::int64_t y = 0; y < block.rows; ++y)
                for (std::int64_t x = 0; x < block.columns; ++x)
                    all[std::size_t((block.row + y) * grid.columns + block.column + x)] =
                        (*cells)[std::size_t(y * block.columns + x)];
        }
        return all;
    }
    struct Found {
        double high = -1e300, low = 1e300, sum = 0;
        std::uint32_t count = 0;
    };
    static std::map<std::size_t, Found> byBruteForce(const RasterGrid& grid,
                                                     std::optional<int> onlyClass = {}) {
        std::map<std::size_t, Found> cells;
        for (const ScanPoint& point : points()) {
            if (onlyClass && point.classification != *onlyClass) continue;
            const double column = std::floor((point.position.x - grid.left) / grid.cell);
            const double row = std::floor((grid.top - point.position.y) / grid.cell);
            if (column < 0 || row < 0 || column >= double(grid.columns) || row >= double(grid.rows)) continue;
            Found& cell = cells[std::size_t(row) * std::size_t(grid.columns) + std::size_t(column)];
            cell.high = std::max(cell.high, point.position.z);
            cell.low = std::min(cell.low, point.position.z);
            cell.sum += point.position.z;
            ++cell.count;
        }
        return cells;
    }

  private:
    static inline SurveyedCloud* all_ = nullptr;
};

TEST_F(Elevation, OfEveryKindIsWhatBruteForceFinds) {
    // Samples in memory round by hundredths of a millimetre: no cell begins where the scan's grid has points.
    const std::string offGrid = "389399.0005,5819699.0005,389521.0005,5819791.0005";
    for (const char* cell : {"0.7", "5"})
        for (const CellValue value :
             {CellValue::Highest, CellValue::Lowest, CellValue::Mean, CellValue::Count}) {
            auto raster = planRaster(
                cloud(), requested(RasterKind::Elevation,
                                   {{"cell", cell}, {"value", std::string(name(value))}, {"bbox", offGrid}}));
            ASSERT_TRUE(raster) << raster.error().message;
            const auto truth = byBruteForce(raster->layout.grid);
            const auto cells = cellsOfRaster(*raster);
            std::uint64_t counted = 0;
            for (std::size_t i = 0; i < cells.size(); ++i) {
                const auto at = truth.find(i);
                if (value == CellValue::Count) {
                    const auto count = std::bit_cast<std::uint32_t>(cells[i]);
                    ASSERT_EQ(count, at == truth.end() ? 0 : at->second.count) << i;
                    counted += count;
                } else if (at == truth.end()) {
                    ASSERT_EQ(cells[i], noElevation) << i;
                } else if (value == CellValue::Mean) {
                    ASSERT_NEAR(cells[i], at->second.sum / at->second.count, 2e-4) << i;
                } else {
                    ASSERT_NEAR(cells[i], value == CellValue::Highest ? at->second.high : at->second.low,
                                2e-4)
                        << i;
                }
            }
            if (value == CellValue::Count) {
                EXPECT_EQ(counted, points().size()) << "every point lies in a cell";
            }
        }
}

TEST_F(Elevation, NeitherBlocksNorThreadsShow) {
    auto raster = planRaster(
        cloud(), requested(RasterKind::Elevation, {{"cell", "0.31"}, {"fill", "6"}, {"value", "mean"}}));
    ASSERT_TRUE(raster);
    ASSERT_EQ(raster->layout.grid.blocks(), 1);
    const auto whole = cellsOfRaster(*raster);
    raster->layout.grid.block = 96;
    ASSERT_GT(raster->layout.grid.blocks(), 12);
    EXPECT_TRUE(cellsOfRaster(*raster) == whole);
    raster->elevation.threads = 4;
    EXPECT_TRUE(cellsOfRaster(*raster) == whole);
}

TEST_F(Elevation, WhatTheViewDoesNotShowIsNoPoint) {
    auto raster = planRaster(
        cloud(), requested(RasterKind::Elevation, {{"cell", "2"}, {"classes", "3"}, {"value", "count"}}));
    ASSERT_TRUE(raster);
    const auto truth = byBruteForce(raster->layout.grid, 3);
    const auto cells = cellsOfRaster(*raster);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto at = truth.find(i);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(cells[i]), at == truth.end() ? 0 : at->second.count);
    }
    raster = planRaster(cloud(), requested(RasterKind::Elevation,
                                           {{"cell", "2"}, {"clip", "389410,5819710,0,389430,5819730,100"}}));
    ASSERT_TRUE(raster);
    const RasterGrid& grid = raster->layout.grid;
    const auto clipped = cellsOfRaster(*raster);
    for (std::size_t i = 0; i < clipped.size(); ++i) {
        const double x = grid.left + (double(i % std::size_t(grid.columns)) + 0.5) * grid.cell;
        const double y = grid.top - (double(i / std::size_t(grid.columns)) + 0.5) * grid.cell;
        const bool within = x > 389410 && x < 389430 && y > 5819710 && y < 5819730;
        if (!within) {
            ASSERT_EQ(clipped[i], noElevation) << x << " " << y;
        }
    }
}

// The round hole of radius 6 is closed where it is allowed to be, out of what is around it; beyond the edge of the scan nothing is made up.
TEST_F(Elevation, HolesAreClosedAndEdgesAreNot) {
    const WordValues words{{"cell", "1"}, {"bbox", "389390,5819690,389460,5819780"}};
    const auto bare = planRaster(cloud(), requested(RasterKind::Elevation, words));
    WordValues more = words;
    more.emplace_back("fill", "12");
    const auto full = planRaster(cloud(), requested(RasterKind::Elevation, more));
    ASSERT_TRUE(bare && full);
    const RasterGrid& grid = bare->layout.grid;
    const auto before = cellsOfRaster(*bare), after = cellsOfRaster(*full);
    const auto at = [&](double x, double y) {
        return std::size_t(grid.rowOf(5819700 + y)) * std::size_t(grid.columns) +
               std::size_t(grid.columnOf(389400 + x));
    };
    EXPECT_EQ(before[at(40.5, 40.5)], noElevation);
    ASSERT_NE(after[at(40.5, 40.5)], noElevation);
    EXPECT_NEAR(after[at(40.5, 40.5)], 34, 6);
    EXPECT_EQ(after[at(-4.5, 40.5)], noElevation) << "west of the scan";
    for (std::size_t i = 0; i < before.size(); ++i)
        if (before[i] != noElevation) {
            ASSERT_EQ(before[i], after[i]);
        }
    // One hole by hand: the nearest in eight directions, by the inverse square of their distance.
    const std::size_t hole = at(40.5, 40.5);
    double sum = 0, weights = 0;
    const auto width = std::ptrdiff_t(grid.columns);
    for (const auto& [step, length] : {std::pair(std::ptrdiff_t(1), 1.0),
                                       {std::ptrdiff_t(-1), 1.0},
                                       {width, 1.0},
                                       {-width, 1.0},
                                       {width + 1, std::sqrt(2.0)},
                                       {width - 1, std::sqrt(2.0)},
                                       {-width + 1, std::sqrt(2.0)},
                                       {-width - 1, std::sqrt(2.0)}})
        for (int i = 1; i * length <= 12; ++i) {
            const float there = before[std::size_t(std::ptrdiff_t(hole) + i * step)];
            if (there == noElevation) continue;
            const double weight = 1 / (i * length * i * length);
            sum += weight * double(there);
            weights += weight;
            break;
        }
    EXPECT_NEAR(after[hole], sum / weights, 1e-5);
}

TEST_F(Elevation, StopsWhenItIsToldTo) {
    const auto raster = planRaster(cloud(), requested(RasterKind::Elevation, {}));
    ASSERT_TRUE(raster);
    std::stop_source stop;
    stop.request_stop();
    const auto cells = elevationCells(cloud(), *raster, raster->layout.grid.blockAt(0), stop.get_token());
    ASSERT_FALSE(cells);
    EXPECT_EQ(cells.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace scancast::test
