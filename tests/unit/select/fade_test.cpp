#include "renderer/select/fade.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace scancast {
namespace {

constexpr double details[] = {0.1, 1, 2, 4, 50};
constexpr double bands[] = {0.05, 0.2, 0.5, 1};

TEST(FadeShares, OutsideTheBandOneLevelIsDrawn) {
    for (const double detail : details)
        for (const double band : bands) {
            EXPECT_EQ(fadeShares(detail, detail, band).own, 1);
            EXPECT_EQ(fadeShares(detail, detail, band).children, 0);
            EXPECT_EQ(fadeShares(detail * (1 + band) * 1.0000001, detail, band).own, 0);
            EXPECT_EQ(fadeShares(detail * (1 + band) * 1.0000001, detail, band).children, 1);
        }
}

TEST(FadeShares, WithoutABandLevelsSwitch) {
    for (const double detail : {0.0, 1.0, 3.0}) {
        EXPECT_EQ(fadeShares(detail, detail, 0).own, 1);
        EXPECT_EQ(fadeShares(detail + 1e-9, detail, 0).own, 0);
        EXPECT_EQ(fadeShares(detail + 1e-9, detail, 0).children, 1);
    }
}

TEST(FadeShares, FullDetailRefinesEverythingWhateverTheBand) {
    for (const double band : bands) {
        EXPECT_EQ(fadeShares(1e-300, 0, band).own, 0);
        EXPECT_EQ(fadeShares(1e-300, 0, band).children, 1);
    }
    EXPECT_EQ(fadeBand(0), 0);
}

TEST(FadeShares, ChangeLittleByLittleAndInOneDirection) {
    constexpr int steps = 1000;
    for (const double detail : details)
        for (const double band : bands) {
            FadeShares before{1, 0};
            for (int i = 0; i <= steps; ++i) {
                const FadeShares now =
                    fadeShares(detail * std::pow(1 + band, double(i) / steps), detail, band);
                ASSERT_LE(now.own, before.own);
                ASSERT_GE(now.children, before.children);
                ASSERT_LT(before.own - now.own, 0.01);
                ASSERT_LT(now.children - before.children, 0.01);
                before = now;
            }
            EXPECT_LT(before.own, 0.01);
        }
}

// No holes: whatever the spacing, one of the two levels is whole.
TEST(FadeShares, TheNodeStaysWholeUntilItsChildrenAre) {
    bool together = false;
    for (double spacing = 0.5; spacing < 4; spacing *= 1.001) {
        const FadeShares shares = fadeShares(spacing, 1, 0.7);
        EXPECT_TRUE(shares.own == 1 || shares.children == 1) << spacing;
        together |= shares.own > 0 && shares.children > 0;
    }
    EXPECT_TRUE(together);
}

TEST(FadeBand, IsWiderForCoarserPictures) {
    double before = 0;
    for (const double detail : {0.1, 0.5, 1.0, 2.0, 4.0, 100.0}) {
        EXPECT_GE(fadeBand(detail), before);
        before = fadeBand(detail);
    }
    EXPECT_LT(before, 1);  // else a node would fade out while its children do
}

std::vector<std::uint32_t> drawn(std::uint32_t count, double share) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < count; ++i)
        if (isDrawn(i, lastTurn(share))) out.push_back(i);
    return out;
}

TEST(Turns, AreAsManyAsTheShareSaysAndNested) {
    for (const std::uint32_t count : {1u, 100u, 5000u, 40000u}) {
        std::vector<std::uint32_t> before;
        for (int percent = 1; percent <= 100; ++percent) {
            const auto now = drawn(count, percent / 100.0);
            EXPECT_NEAR(double(now.size()), count * percent / 100.0, 4);
            EXPECT_TRUE(std::ranges::includes(now, before));
            before = now;
        }
        EXPECT_EQ(before.size(), count);
    }
}

// Evenly spread: between two that are drawn lie, by the three-gap theorem, never many more than the share's
// inverse.
TEST(Turns, LeaveNoGapsAndMakeNoClumps) {
    for (const double share : {0.03, 0.1, 0.25, 0.5, 0.8}) {
        const auto indices = drawn(20000, share);
        for (std::size_t i = 1; i < indices.size(); ++i)
            ASSERT_LE(indices[i] - indices[i - 1], 2.7 / share + 1) << share;
    }
}

TEST(Turns, TheEndsOfTheScale) {
    EXPECT_EQ(lastTurn(1), everyTurn);
    EXPECT_EQ(lastTurn(2), everyTurn);
    EXPECT_EQ(lastTurn(0), 0u);
    EXPECT_EQ(lastTurn(-1), 0u);
    EXPECT_EQ(lastTurn(0.5), 0x80000000u);
    EXPECT_TRUE(isDrawn(0xffffffffu, everyTurn));
}

}  // namespace
}  // namespace scancast
