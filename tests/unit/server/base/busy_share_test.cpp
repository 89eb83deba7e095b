#include "server/base/busy_share.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class BusyShareTest : public ::testing::Test {
  protected:
    void work(milliseconds time) {
        share.begin(now);
        share.end(now += time);
    }
    BusyShare share;
    BusyShare::Time now{std::chrono::hours(5)};
};

TEST_F(BusyShareTest, IsTheShareOfTheLastSeconds) {
    EXPECT_EQ(share.of(now), 0);
    for (int i = 0; i < 100; ++i) {
        work(milliseconds(300));
        now += milliseconds(700);
    }
    EXPECT_NEAR(share.of(now), 0.3, 0.02);
    now += seconds(7);
    EXPECT_NEAR(share.of(now), 0.3 * 7 / 14, 0.02);
    now += seconds(30);
    EXPECT_EQ(share.of(now), 0);
}

TEST_F(BusyShareTest, WhatIsNotFinishedCounts) {
    share.begin(now);
    EXPECT_EQ(share.of(now), 0);
    EXPECT_NEAR(share.of(now + seconds(7)), 0.5, 0.03);
    EXPECT_EQ(share.of(now + seconds(600)), 1) << "and never more than all";
    share.end(now += seconds(600));
    EXPECT_EQ(share.of(now), 1);
    share.end(now + seconds(1));
    EXPECT_LT(share.of(now + seconds(1)), 1) << "an end without a beginning is none";
}

}  // namespace
}  // namespace scancast
