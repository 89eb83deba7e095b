#include "renderer/raster/raster_grid.hpp"

#include <gtest/gtest.h>

#include "tests/unit/raster/raster_clouds.hpp"

namespace scancast::test {
namespace {

class Grid : public ::testing::Test {
  protected:
    static void SetUpTestSuite() { cloud_ = new std::shared_ptr<const Cloud>(surveyedCloud().cloud); }
    static void TearDownTestSuite() { delete cloud_; }
    static const Cloud& cloud() { return **cloud_; }
    static Expected<RasterGrid> gridOf(const WordValues& words, std::uint64_t most = 1'000'000) {
        RasterLimits limits;
        limits.mostCells = most;
        return rasterGrid(cloud(), requested(RasterKind::Elevation, words), limits);
    }
    static Error refusal(const WordValues& words, std::uint64_t most = 1'000'000) {
        const auto grid = gridOf(words, most);
        EXPECT_FALSE(grid);
        return grid ? Error{} : grid.error();
    }

  private:
    static inline std::shared_ptr<const Cloud>* cloud_ = nullptr;
};

TEST_F(Grid, CoversAllOfTheCloudInWholeCells) {
    for (const char* cell : {"0.3", "1", "7"}) {
        const auto grid = gridOf({{"cell", cell}});
        ASSERT_TRUE(grid) << grid.error().message;
        EXPECT_NEAR(std::remainder(grid->left, grid->cell), 0, 1e-6);
        EXPECT_NEAR(std::remainder(grid->top, grid->cell), 0, 1e-6);
        EXPECT_LE(grid->left, cloud().bounds[0].x);
        EXPECT_GE(grid->top, cloud().bounds[1].y);
        EXPECT_LT(grid->columnOf(cloud().bounds[1].x), double(grid->columns));
        EXPECT_LT(grid->rowOf(cloud().bounds[0].y), double(grid->rows));
        EXPECT_GT(grid->columnOf(cloud().bounds[1].x), double(grid->columns) - 2);
    }
    const auto automatic = gridOf({}, 100'000'000);
    ASSERT_TRUE(automatic);
    EXPECT_NEAR(automatic->cell, 3 * cloud().spacing, 2.5 * cloud().spacing);
}

TEST_F(Grid, NoPointOnAnEdgeIsLostToRounding) {
    // Multiples of 0.01 or 0.3 as doubles lie on either side of what they stand for.
    Cloud moved = cloud();
    for (int i = 0; i < 3000; ++i) {
        moved.bounds[0] = {389400 + i * 0.01, 5819700 + i * 0.03, 0};
        moved.bounds[1] = {389401 + i * 0.01, 5819701 + i * 0.15, 1};
        for (const char* cell : {"0.01", "0.02", "0.3", "0.7"}) {
            RasterLimits limits;
            limits.mostCells = std::uint64_t(1) << 40;
            const auto grid = rasterGrid(moved, requested(RasterKind::Elevation, {{"cell", cell}}), limits);
            ASSERT_TRUE(grid) << grid.error().message;
            const double column = grid->columnOf(moved.bounds[0].x), row = grid->rowOf(moved.bounds[1].y);
            ASSERT_TRUE(column >= 0 && column <= 1) << cell << ", " << i;
            ASSERT_TRUE(row >= 0 && row <= 1) << cell << ", " << i;
        }
    }
}

TEST_F(Grid, BoundsAreTakenAsTheyAre) {
    const auto grid = gridOf({{"cell", "0.5"}, {"bbox", "389400.25,5819700.25,389410.25,5819705.3"}});
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->left, 389400.25);
    EXPECT_EQ(grid->top, 5819705.3);
    EXPECT_EQ(grid->columns, 20);
    EXPECT_EQ(grid->rows, 11) << "the last row reaches beyond";
}

TEST_F(Grid, BlocksAreAllCellsOnce) {
    auto grid = *gridOf({{"cell", "0.09"}}, 100'000'000);
    grid.block = 512;
    std::uint64_t cells = 0;
    for (std::int64_t i = 0; i < grid.blocks(); ++i) {
        const CellWindow block = grid.blockAt(i);
        EXPECT_EQ(block.column % grid.tile, 0);
        EXPECT_EQ(block.row % grid.tile, 0);
        cells += std::uint64_t(block.cells());
        const CellWindow more = grid.grown(block, 9);
        EXPECT_GE(more.column, 0);
        EXPECT_LE(more.column + more.columns, grid.columns);
    }
    EXPECT_EQ(cells, grid.cells());
}

TEST_F(Grid, TooManyCellsAreRefusedWithASideThatDoes) {
    const Error error = refusal({{"cell", "0.01"}});
    EXPECT_EQ(error.code, ErrorCode::InvalidArgument);
    EXPECT_EQ(error.field, "cell");
    const std::string word = "with cell=";
    const auto at = error.message.find(word);
    ASSERT_NE(at, std::string::npos) << error.message;
    const std::string better = std::to_string(std::stod(error.message.substr(at + word.size())));
    EXPECT_TRUE(gridOf({{"cell", better}})) << better;
    const auto automatic = gridOf({}, 1000);
    ASSERT_TRUE(automatic) << "what is left open is made to fit";
    EXPECT_LE(automatic->cells(), 1000U);
    const Error row =
        refusal({{"cell", "0.0001"}, {"bbox", "389410,5819710,389500,5819710.0001"}}, 2'000'000);
    EXPECT_EQ(row.field, "cell") << "900,000 cells in a row fill tiles of 256 rows";
    EXPECT_EQ(refusal({{"cell", "1e-300"}}).field, "cell");
    EXPECT_EQ(refusal({{"cell", "1e-12"}, {"bbox", "389410,5819710,389410.0000001,5819710.0000001"}}).field,
              "cell");
    EXPECT_EQ(refusal({{"bbox", "0,0,10,10"}}).field, "bbox");
    EXPECT_EQ(refusal({{"cell", "1"}, {"bbox", "-9e14,-9e14,9e14,9e14"}}).field, "cell");
}

}  // namespace
}  // namespace scancast::test
