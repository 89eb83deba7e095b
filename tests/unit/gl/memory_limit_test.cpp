#include "renderer/device/gl/memory/memory_limit.hpp"

#include <gtest/gtest.h>

namespace scancast::gl {
namespace {

constexpr std::uint64_t gib = std::uint64_t(1) << 30;
constexpr std::int64_t tile = 2048 * 2048, screen4K = 3840 * 2160, screen8K = 7680 * 4320;

TEST(PixelsAtOnce, OfAGpuAreWhatItsMemoryHolds) {
    // What is left beside samples, which take three quarters.
    EXPECT_EQ(pixelsAtOnce({false, 80 * gib / 4, 2 * gib}), screen8K);
    EXPECT_GE(pixelsAtOnce({false, 8 * gib / 4, 2 * gib}), screen4K);
    EXPECT_LE(pixelsAtOnce({false, 4 * gib / 4, 2 * gib}), tile);
    EXPECT_EQ(pixelsAtOnce({false, 0, 2 * gib}), 0) << "who does not say draws tiles";
}

TEST(PixelsAtOnce, FitAStorageBlock) {
    for (const bool software : {false, true}) {
        const std::int64_t pixels = pixelsAtOnce({software, 100 * gib, std::size_t{32} << 20});
        EXPECT_EQ(pixels, std::int64_t{4} << 20);
    }
}

TEST(PixelsAtOnce, OnTheCpuAreAScreenWhereThereIsMemory) {
    EXPECT_EQ(pixelsAtOnce({true, 100 * gib, gib}), screen4K);
    EXPECT_EQ(pixelsAtOnce({true, 3 * gib, gib}), 0);
}

}  // namespace
}  // namespace scancast::gl
