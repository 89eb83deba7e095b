// Every point is read by exactly one rank, and what a scan says at its end is told by one, however many ranks there are.
#include "ranks/ingest/reading_shares.hpp"

#include <gmock/gmock.h>

namespace scancast {
namespace {

struct Totals {
    std::vector<std::uint64_t> points;  ///< read of each scan
    std::vector<int> tellers;
    std::vector<std::uint64_t> ofRank;
};

Totals add(std::span<const ReadableScan> scans, int ranks) {
    Totals all{std::vector<std::uint64_t>(scans.size()), std::vector<int>(scans.size()), {}};
    for (int r = 0; r < ranks; ++r) {
        const auto shares = shareReading(scans, r, ranks);
        std::uint64_t own = 0;
        for (std::size_t i = 0; i < scans.size(); ++i) {
            const std::uint64_t points = shares[i].all ? scans[i].points.value_or(7) : shares[i].count;
            EXPECT_TRUE(shares[i].all || shares[i].count == 0 || shares[i].first == all.points[i])
                << "parts follow each other";
            all.points[i] += points;
            all.tellers[i] += shares[i].tells();
            own += points;
        }
        all.ofRank.push_back(own);
    }
    return all;
}

TEST(ReadingShares, EveryPointIsReadOnceAndEveryScanToldOnce) {
    const std::vector<ReadableScan> scans{{1000, true}, {10, false},        {std::nullopt, false},
                                          {1, true},    {500, false, true}, {999'999, true},
                                          {3, false}};
    for (int ranks = 1; ranks <= 9; ++ranks) {
        SCOPED_TRACE(ranks);
        const Totals all = add(scans, ranks);
        for (std::size_t i = 0; i < scans.size(); ++i) {
            EXPECT_EQ(all.points[i], scans[i].points.value_or(7)) << i;
            EXPECT_EQ(all.tellers[i], 1) << i;
        }
    }
}

TEST(ReadingShares, OneScanIsReadByAllAlike) {
    const std::vector<ReadableScan> one{{(std::uint64_t(1) << 40) + 5, true}};
    const Totals all = add(one, 64);
    for (const std::uint64_t points : all.ofRank) EXPECT_NEAR(double(points), double(*one[0].points) / 64, 1);
}

TEST(ReadingShares, WhatCannotBeDividedIsTheFirstRanksWhereThatIsWanted) {
    const std::vector<ReadableScan> scans{{5, false}, {5, false, true}};
    EXPECT_TRUE(shareReading(scans, 0, 2)[1].all);
    EXPECT_FALSE(shareReading(scans, 1, 2)[1].all);
}

TEST(ReadingShares, NobodyKnowsHowManyPointsThereAre) {
    const std::vector<ReadableScan> scans(4, ReadableScan{});
    const Totals all = add(scans, 2);
    EXPECT_THAT(all.ofRank, testing::ElementsAre(14, 14));
}

}  // namespace
}  // namespace scancast
