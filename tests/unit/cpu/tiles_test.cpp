#include "renderer/device/cpu/tiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast::cpu {
namespace {

std::vector<PreparedRun> randomRuns(const Rect& area, int count) {
    test::Numbers numbers(7);
    std::vector<PreparedRun> runs(static_cast<std::size_t>(count));
    for (PreparedRun& run : runs) {
        const int x = int(numbers.uniform(area.x0, area.x1)), y = int(numbers.uniform(area.y0, area.y1));
        run.bounds =
            Rect{x, y, x + int(numbers.uniform(1, 200)), y + int(numbers.uniform(1, 200))}.intersect(area);
        run.work = numbers.uniform(1, 1e6);
    }
    return runs;
}

void expectExactCover(const Rect& area, const std::vector<Tile>& tiles) {
    std::vector<int> hits(static_cast<std::size_t>(area.width()) * area.height());
    for (const Tile& t : tiles) {
        ASSERT_FALSE(t.area.empty());
        for (int y = t.area.y0; y < t.area.y1; ++y) {
            for (int x = t.area.x0; x < t.area.x1; ++x) {
                ++hits[static_cast<std::size_t>(y - area.y0) * area.width() + (x - area.x0)];
            }
        }
    }
    EXPECT_EQ(std::ranges::count(hits, 1), std::ssize(hits)) << "every pixel belongs to exactly one tile";
}

TEST(Tiles, CoverTheAreaExactlyOnceAndKnowEveryRunThatReachesThem) {
    for (const Rect area :
         {Rect{0, 0, 1280, 720}, Rect{17, 5, 18, 6}, Rect{3, 9, 1003, 41}, Rect{0, 0, 63, 900}}) {
        const std::vector<PreparedRun> runs = randomRuns(area, 300);
        for (const int wanted : {1, 2, 7, 400}) {
            const std::vector<Tile> tiles = cutIntoTiles(area, runs, wanted);
            expectExactCover(area, tiles);
            for (const Tile& t : tiles) {
                EXPECT_TRUE(std::ranges::is_sorted(t.runs)) << "front to back, as given";
                for (std::uint32_t i = 0; i < runs.size(); ++i) {
                    const bool reaches = !runs[i].bounds.intersect(t.area).empty();
                    EXPECT_EQ(reaches, std::ranges::binary_search(t.runs, i));
                }
            }
        }
    }
}

TEST(Tiles, FollowTheWork) {
    // All work in one corner: without following it, one of 16 tiles would hold everything.
    const Rect area{0, 0, 1280, 720};
    std::vector<PreparedRun> runs(1000);
    test::Numbers numbers(8);
    double total = 0;
    for (PreparedRun& run : runs) {
        const int x = int(numbers.uniform(0, 240)), y = int(numbers.uniform(0, 150));
        run.bounds = {x, y, x + 8, y + 8};
        run.work = 1e6;
        total += run.work;
    }
    const std::vector<Tile> tiles = cutIntoTiles(area, runs, 16);
    EXPECT_GE(tiles.size(), 16u);
    EXPECT_LT(tiles[0].work, total / 6);
    EXPECT_TRUE(std::ranges::is_sorted(tiles, std::ranges::greater{}, &Tile::work)) << "heaviest first";
}

TEST(Tiles, StayWithinTheirLargestSize) {
    const Rect area{0, 0, 8192, 8192};
    for (const Tile& t : cutIntoTiles(area, {}, 1)) {
        EXPECT_LE(t.area.width() * t.area.height(), maxTilePixels);
    }
}

}  // namespace
}  // namespace scancast::cpu
