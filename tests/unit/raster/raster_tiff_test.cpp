// Files against libtiff's own reader, which has seen nothing of how they were written but their bytes.
#include "renderer/raster/raster_tiff.hpp"

#include <gtest/gtest.h>
#include <tiffio.h>

#include <cstring>

#include "renderer/raster/elevation.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/raster/raster_clouds.hpp"

namespace scancast::test {
namespace {

struct WrittenFile {
    std::vector<std::byte> bytes;
    bool before = false;  ///< some came before the last block
};

RasterLayout layoutOf(CellKind kind, RasterPacking packing, std::int64_t columns, std::int64_t rows) {
    RasterLayout layout;
    layout.grid = {.left = 389400,
                   .top = 5819800,
                   .cell = 0.5,
                   .columns = columns,
                   .rows = rows,
                   .tile = 256,
                   .block = 512};
    layout.kind = kind;
    layout.packing = packing;
    layout.keys = {{1024, std::uint16_t(1)}, {1025, std::uint16_t(1)}, {3072, std::uint16_t(25833)}};
    layout.unit = "metre";
    layout.value = "highest";
    layout.title = "Town & country";
    return layout;
}

std::uint32_t cellAt(std::int64_t column, std::int64_t row) {
    return std::uint32_t(row * 100'003 + column * 7);
}

class RasterFile : public ::testing::TestWithParam<std::tuple<CellKind, RasterPacking>> {
  protected:
    WrittenFile written(const RasterLayout& layout) const {
        WrittenFile file;
        auto tiff = RasterTiff::create(layout, {folder.path(), "--here"});
        EXPECT_TRUE(tiff) << tiff.error().message;
        while (!(*tiff)->isDone()) {
            if ((*tiff)->ready() > 0) {
                file.before = file.before || ((*tiff)->nextBlock() && file.bytes.size() > 100);
                const auto part = (*tiff)->take(100'000);
                file.bytes.insert(file.bytes.end(), part->begin(), part->end());
                continue;
            }
            const CellWindow block = *(*tiff)->nextBlock();
            std::vector<std::byte> cells(std::size_t(block.cells()) * 4);
            for (std::int64_t y = 0; y < block.rows; ++y)
                for (std::int64_t x = 0; x < block.columns; ++x) {
                    const std::uint32_t cell = cellAt(block.column + x, block.row + y);
                    const float height = float(cell) / 8;
                    std::memcpy(
                        &cells[std::size_t(y * block.columns + x) * 4],
                        layout.kind == CellKind::Elevation ? static_cast<const void*>(&height) : &cell, 4);
                }
            const auto put = (*tiff)->put(cells);
            EXPECT_TRUE(put) << put.error().message;
        }
        EXPECT_EQ((*tiff)->size(), file.bytes.size());
        return file;
    }
    const TemporaryFolder folder;
};

TEST_P(RasterFile, IsReadBackCellForCell) {
    const auto [kind, packing] = GetParam();
    const RasterLayout layout = layoutOf(kind, packing, 1300, 777);
    const WrittenFile file = written(layout);
    EXPECT_EQ(file.before, packing == RasterPacking::None) << "what is not packed goes out while it is made";
    const std::string path = folder.file("raster.tif");
    {
        std::FILE* const out = std::fopen(path.c_str(), "wb");
        std::fwrite(file.bytes.data(), 1, file.bytes.size(), out);
        std::fclose(out);
    }
    TIFF* const tiff = TIFFOpen(path.c_str(), "r");
    ASSERT_NE(tiff, nullptr);
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    EXPECT_EQ(width, 1300U);
    EXPECT_EQ(height, 777U);
    EXPECT_EQ(TIFFNumberOfTiles(tiff), 6U * 4U);
    std::vector<std::byte> tile(std::size_t(TIFFTileSize(tiff)));
    std::size_t wrong = 0;
    for (std::uint32_t top = 0; top < height; top += 256)
        for (std::uint32_t left = 0; left < width; left += 256) {
            ASSERT_GT(TIFFReadTile(tiff, tile.data(), left, top, 0, 0), 0);
            for (std::uint32_t y = 0; y < 256; ++y)
                for (std::uint32_t x = 0; x < 256; ++x) {
                    const std::uint32_t cell = cellAt(left + x, top + y);
                    const bool outside = left + x >= width || top + y >= height;
                    const float value = outside ? noElevation : float(cell) / 8;
                    const std::uint32_t number = outside ? 0 : cell;
                    const void* const expected =
                        kind == CellKind::Elevation ? static_cast<const void*>(&value) : &number;
                    wrong += std::memcmp(&tile[(y * 256 + x) * 4], expected, 4) != 0;
                }
        }
    EXPECT_EQ(wrong, 0U);
    TIFFClose(tiff);
}

INSTANTIATE_TEST_SUITE_P(Kinds, RasterFile,
                         ::testing::Combine(::testing::Values(CellKind::Elevation, CellKind::Count,
                                                              CellKind::Color),
                                            ::testing::Values(RasterPacking::None, RasterPacking::Deflate)));

TEST(RasterFileLimits, LargeOnesAreBigTiffWhoseLastTileIsWhereItSays) {
    const RasterLayout layout = layoutOf(CellKind::Elevation, RasterPacking::None, 70'000, 20'000);
    EXPECT_TRUE(layout.isBig());
    std::vector<std::int64_t> tiles;
    for (std::int64_t i = 0; i < layout.grid.tiles(); ++i) tiles.push_back(i);
    const auto skeleton = tiffSkeleton(layout, tiles);
    ASSERT_TRUE(skeleton) << skeleton.error().message;
    ASSERT_EQ(skeleton->head.size(), 16U);
    EXPECT_EQ(int(skeleton->head[2]), 43) << "BigTIFF's version";
    std::uint64_t directory = 0;
    std::memcpy(&directory, &skeleton->head[8], 8);
    EXPECT_GE(directory, 16 + layout.allTiles());
    EXPECT_LT(directory, 16 + layout.allTiles() + skeleton->tail.size());
}

TEST(RasterFileLimits, NoMoreWaitsThanMay) {
    const TemporaryFolder folder;
    RasterLayout layout = layoutOf(CellKind::Color, RasterPacking::Deflate, 600, 300);
    auto tiff = RasterTiff::create(layout, {folder.path(), "--here", 20'000});
    ASSERT_TRUE(tiff);
    std::vector<std::byte> noise(std::size_t((*tiff)->nextBlock()->cells()) * 4);
    for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = std::byte(uniform(i) * 256);
    const auto put = (*tiff)->put(noise);
    ASSERT_FALSE(put);
    EXPECT_EQ(put.error().code, ErrorCode::ResourceLimit);
    EXPECT_NE(put.error().message.find("compress=none"), std::string::npos) << put.error().message;
    EXPECT_FALSE((*tiff)->put(std::span(noise).first(16))) << "other cells than it wants";
}

}  // namespace
}  // namespace scancast::test
