#include "renderer/image/colormap.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

namespace scancast {
namespace {

double luminance(const Rgb8& c) {
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

TEST(Colormap, GreyIsTheIdentity) {
    const auto grey = *colormap("grey");
    for (std::size_t i = 0; i < 256; ++i) {
        for (const auto channel : grey[i]) EXPECT_NEAR(channel, static_cast<double>(i), 1) << i;
    }
}

TEST(Colormap, ViridisGrowsEverBrighter) {
    // Its defining property: luminance is monotone, so that the ramp also reads without colour.
    const auto viridis = *colormap("viridis");
    for (std::size_t i = 4; i < 256; i += 4)
        EXPECT_GT(luminance(viridis[i]), luminance(viridis[i - 4]) - 0.5) << i;
}

TEST(Colormap, EveryNamedMapIsSmooth) {
    for (const auto name : colormapNames) {
        const auto ramp = *colormap(name);
        for (std::size_t i = 1; i < 256; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_LE(std::abs(ramp[i][c] - ramp[i - 1][c]), 9) << name << ' ' << i;
        }
    }
}

TEST(Colormap, UnknownNameIsNothing) {
    EXPECT_FALSE(colormap("jet"));
}

TEST(Colormap, StandardClassesAreToldApart) {
    const std::set<Rgb8> distinct(classificationColors().begin(), classificationColors().begin() + 19);
    EXPECT_EQ(distinct.size(), 19u);
}

TEST(Colormap, NeighbouringLevelsAreToldApart) {
    for (std::size_t i = 1; i < 32; ++i) EXPECT_NE(levelColors()[i], levelColors()[i - 1]);
}

}  // namespace
}  // namespace scancast
