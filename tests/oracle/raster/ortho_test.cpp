// Orthophotos against pictures: what fits into one is that picture, on every device the same bytes; what does not, put together of blocks, is
// what one large picture shows.
#include <gtest/gtest.h>

#include <cstdio>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/raster/raster_plan.hpp"
#include "renderer/render.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"

namespace scancast::test {
namespace {

class Ortho : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        SyntheticSource source(sized(60'000, 10'000), ground, Attributes{.color = true}, 0.001);
        cloud_ = new std::shared_ptr<const Cloud>(*buildCloud(source, BuildOptions{}));
        DeviceOptions cpu;
        cpu.backend = "cpu";
        device_ = createDevice(cpu).value().release();
    }
    static void TearDownTestSuite() {
        delete device_;
        delete cloud_;
    }
    static const Cloud& cloud() { return **cloud_; }

    static std::vector<std::byte> drawn(const OrthoViews& views) {
        const RasterGrid& grid = views.grid;
        std::vector<std::byte> all(grid.cells() * 4);
        for (std::int64_t b = 0; b < grid.blocks(); ++b) {
            const CellWindow block = grid.blockAt(b);
            const auto frame = render(*device_, cloud(), orthoView(cloud(), views, block));
            EXPECT_TRUE(frame) << frame.error().message;
            const auto cells = cellsOf(views, block, {frame->rgba.data(), frame->rgba.size()}).value();
            for (std::int64_t y = 0; y < block.rows; ++y)
                std::copy_n(cells.begin() + y * block.columns * 4, block.columns * 4,
                            all.begin() + ((block.row + y) * grid.columns + block.column) * 4);
        }
        return all;
    }
    static OrthoViews viewsOf(const WordValues& words, int largest) {
        const auto request = rasterRequestOf(RasterKind::Orthophoto, words);
        const auto grid = rasterGrid(cloud(), *request);
        EXPECT_TRUE(grid) << grid.error().message;
        auto views = orthoViews(cloud(), *grid, request->view, largest);
        EXPECT_TRUE(views) << views.error().message;
        return *views;
    }

  private:
    static inline std::shared_ptr<const Cloud>* cloud_ = nullptr;
    static inline Device* device_ = nullptr;
};

TEST_F(Ortho, BlocksShowWhatOnePictureShows) {
    for (const char* method : {"point", "paraboloid"}) {
        for (const char* shading : {"unlit", "eyedome"}) {
            const WordValues words{
                {"cell", "0.25"}, {"method", method}, {"shading", shading}, {"color", "elevation"}};
            const OrthoViews whole = viewsOf(words, 4096), parts = viewsOf(words, 512);
            ASSERT_EQ(whole.grid.blocks(), 1);
            ASSERT_EQ(whole.margin, 0);
            ASSERT_GE(parts.grid.blocks(), 9);
            const auto one = drawn(whole), many = drawn(parts);
            ASSERT_EQ(one.size(), many.size());
            std::size_t other = 0, opaque = 0;
            for (std::size_t i = 0; i < one.size(); i += 4) {
                opaque += one[i + 3] != std::byte(0);
                for (std::size_t c = 0; c < 4; ++c)
                    if (std::abs(int(one[i + c]) - int(many[i + c])) > 8) {
                        ++other;
                        break;
                    }
            }
            EXPECT_GT(opaque, one.size() / 4 / 20) << method;
            EXPECT_LT(double(other), 0.002 * double(one.size() / 4)) << method << " " << shading;
            std::printf("%s %s: %zu of %zu pixels differ\n", method, shading, other, one.size() / 4);
        }
    }
}

TEST_F(Ortho, APixelIsACell) {
    // A point in a cell of its own is drawn there: one pixel a point, nothing else around.
    const OrthoViews views =
        viewsOf({{"cell", "0.25"}, {"method", "point"}, {"samples", "1"}, {"color", "#ff0000"}}, 4096);
    const auto pixels = drawn(views);
    RasterRequest request;
    request.cell = 0.25;
    auto count =
        planRaster(cloud(), *rasterRequestOf(RasterKind::Elevation,
                                             {{"cell", "0.25"}, {"value", "count"}, {"outliers", "hide"}}));
    ASSERT_TRUE(count);
    ASSERT_EQ(count->layout.grid.columns, views.grid.columns);
    std::size_t agree = 0, all = 0;
    const auto cells = elevationOf(cloud(), count->filter, count->layout.grid,
                                   {0, 0, views.grid.columns, views.grid.rows}, count->elevation);
    ASSERT_TRUE(cells);
    for (std::size_t i = 0; i < cells->size(); ++i) {
        const bool has = (*cells)[i] != 0, shown = pixels[i * 4 + 3] != std::byte(0);
        all += has || shown;
        agree += has && shown;
    }
    EXPECT_GT(double(agree), 0.98 * double(all)) << agree << " of " << all;
}

}  // namespace
}  // namespace scancast::test
