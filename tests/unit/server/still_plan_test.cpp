#include "server/stream/still_plan.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

using namespace std::chrono_literals;
using Still = StillPlan::Still;

class StillPlanTest : public testing::Test {
  protected:
    const StillPlan::Time start{};
    StillPlan plan{StillTimes{150ms, 100ms}};

    std::optional<Still> idle(StillPlan::Time now) const { return plan.due(false, false, now); }
};

TEST_F(StillPlanTest, NothingIsDueWithoutAView) {
    EXPECT_FALSE(idle(start + 1h));
    EXPECT_FALSE(plan.dueAt(false));
}

TEST_F(StillPlanTest, OfAViewThatLacksNothingTheFinalOneComesAfterTheQuiet) {
    plan.begin(false, start);
    EXPECT_EQ(plan.dueAt(false), start + 150ms);
    EXPECT_FALSE(idle(start + 149ms));
    EXPECT_EQ(idle(start + 150ms), Still::Final);
    plan.ordered(Still::Final);
    EXPECT_FALSE(idle(start + 1h));
}

TEST_F(StillPlanTest, AnotherViewBeginsAnew) {
    plan.begin(false, start);
    plan.ordered(Still::Final);
    plan.begin(false, start + 200ms);
    EXPECT_FALSE(idle(start + 300ms));
    EXPECT_EQ(idle(start + 350ms), Still::Final);
}

TEST_F(StillPlanTest, StillsGetSharperUntilNothingIsMissing) {
    plan.begin(true, start);
    EXPECT_EQ(idle(start + 150ms), Still::AsFarAsRead);
    plan.ordered(Still::AsFarAsRead);
    EXPECT_FALSE(plan.due(true, true, start + 1s)) << "one after the other";
    plan.drawn(1000, start + 200ms);
    EXPECT_FALSE(idle(start + 299ms));
    EXPECT_EQ(idle(start + 300ms), Still::AsFarAsRead);
    plan.drawn(0, start + 350ms);
    EXPECT_EQ(idle(start + 350ms), Still::Final);
}

TEST_F(StillPlanTest, WhatGetsNoSharperIsGivenUpSoon) {
    plan.begin(true, start);
    auto now = start + 150ms;
    int stills = 0;
    for (; idle(now) == Still::AsFarAsRead; now += 100ms, ++stills) plan.drawn(1000, now);
    EXPECT_EQ(stills, 5);
    EXPECT_EQ(idle(now), Still::Final);
}

TEST_F(StillPlanTest, WhatGetsSharperForeverIsGivenUpLater) {
    plan.begin(true, start);
    auto now = start + 150ms;
    std::uint64_t stills = 0;
    for (; idle(now) == Still::AsFarAsRead; now += 100ms, ++stills) plan.drawn(1000 - stills, now);
    EXPECT_EQ(stills, 20u);
    EXPECT_EQ(idle(now), Still::Final);
}

TEST_F(StillPlanTest, AfterAFailureTheFinalOneIsTried) {
    plan.begin(true, start);
    plan.failed();
    EXPECT_FALSE(plan.due(true, true, start + 1s)) << "while one is still being made";
    EXPECT_EQ(idle(start + 1s), Still::Final);
}

}  // namespace
}  // namespace scancast
