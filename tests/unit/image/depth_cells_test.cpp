// Against a search through all pixels of the picture, each of which asks which cell it is in.
#include "renderer/image/depth_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace scancast {
namespace {

constexpr float nothing = std::numeric_limits<float>::infinity();

Frame sparseFrame(int width, int height, double covered, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(0, 1);
    Frame frame;
    frame.width = width;
    frame.height = height;
    std::vector<float>& depth = frame.depth.own();
    for (int i = 0; i < width * height; ++i)
        depth.push_back(share(random) < covered ? float(1 + share(random)) : nothing);
    return frame;
}

std::vector<float> byAskingPixels(const Frame& frame, int width, int height) {
    std::vector<float> cells(std::size_t(width) * std::size_t(height), nothing);
    std::vector<double> distances(cells.size(), std::numeric_limits<double>::infinity());
    // The first column of pixels that is at or behind i·W/w.
    const auto border = [](int i, int pixels, int among) { return std::floor(double(i) * pixels / among); };
    const auto cellsOf = [&](int pixels, int among) {
        std::vector<int> ofPixel;
        for (int pixel = 0, cell = 0; pixel < pixels; ++pixel) {
            while (border(cell + 1, pixels, among) <= pixel) ++cell;
            ofPixel.push_back(cell);
        }
        return ofPixel;
    };
    const std::vector<int> columns = cellsOf(frame.width, width), rows = cellsOf(frame.height, height);
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const float depth = frame.depth[std::size_t(y) * std::size_t(frame.width) + std::size_t(x)];
            const int i = columns[std::size_t(x)], j = rows[std::size_t(y)];
            const double dx =
                x + 0.5 - (border(i, frame.width, width) + border(i + 1, frame.width, width)) / 2;
            const double dy =
                y + 0.5 - (border(j, frame.height, height) + border(j + 1, frame.height, height)) / 2;
            const std::size_t cell = std::size_t(j) * std::size_t(width) + std::size_t(i);
            if (std::isinf(depth) || dx * dx + dy * dy >= distances[cell]) continue;
            distances[cell] = dx * dx + dy * dy;
            cells[cell] = depth;
        }
    }
    return cells;
}

TEST(DepthCells, EachHasThePixelNearestToItsMiddle) {
    unsigned seed = 1;
    for (const auto& [width, height] :
         {std::pair{640, 360}, {333, 517}, {161, 90}, {320, 4}, {7, 5}, {2, 2}, {1, 1}}) {
        for (const double covered : {0.0, 0.02, 0.4, 1.0}) {
            const Frame frame = sparseFrame(width, height, covered, ++seed);
            const DepthCells cells = depthCells(frame);
            EXPECT_EQ(cells.depth, byAskingPixels(frame, cells.width, cells.height))
                << width << " x " << height << ", " << covered;
        }
    }
}

TEST(DepthCells, KeepThePicturesProportions) {
    using Size = std::array<int, 2>;
    EXPECT_EQ(depthCellsOf(1280, 720), (Size{160, 90}));
    EXPECT_EQ(depthCellsOf(720, 1280), (Size{90, 160}));
    EXPECT_EQ(depthCellsOf(1024, 768), (Size{160, 120}));
    EXPECT_EQ(depthCellsOf(4096, 4096), (Size{160, 160}));
    EXPECT_EQ(depthCellsOf(16384, 16), (Size{160, 2}));
    EXPECT_EQ(depthCellsOf(100, 50), (Size{100, 50})) << "never more cells than pixels";
    EXPECT_EQ(depthCellsOf(500, 1), (Size{160, 1}));
    EXPECT_EQ(depthCellsOf(1, 1), (Size{1, 1}));
}

}  // namespace
}  // namespace scancast
