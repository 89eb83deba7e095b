#include "server/stream/still_plan.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

using namespace std::chrono_literals;
using Still = StillPlan::Still;

class StillPlanTest : public testing::Test {
  protected:
    const StillPlan::Time start{};
    StillPlan plan{StillTimes{150ms, 50ms, 100ms}};

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

TEST_F(StillPlanTest, ATrialThatIsDrawnIsTheFinalOne) {
    plan.begin(true, start);
    EXPECT_EQ(idle(start + 150ms), Still::Trial);
    plan.ordered(Still::Trial);
    EXPECT_FALSE(plan.due(true, true, start + 1s)) << "one after the other";
    plan.drawn(Still::Trial, 0, start + 200ms);
    EXPECT_FALSE(idle(start + 1h));
}

TEST_F(StillPlanTest, WhatIsADiskAwayIsTriedAgainSoon) {
    plan.begin(true, start);
    plan.lacked(start + 150ms);
    EXPECT_FALSE(idle(start + 199ms));
    EXPECT_EQ(idle(start + 200ms), Still::Trial);
    plan.lacked(start + 200ms);
    EXPECT_EQ(idle(start + 200ms), Still::Sharper);
}

TEST_F(StillPlanTest, StillsGetSharperUntilATrialFindsEverything) {
    plan.begin(true, start);
    plan.lacked(start + 150ms);
    plan.lacked(start + 200ms);
    plan.drawn(Still::Sharper, 1000, start + 250ms);
    EXPECT_FALSE(idle(start + 349ms));
    EXPECT_EQ(idle(start + 350ms), Still::Trial);
    plan.lacked(start + 350ms);
    EXPECT_EQ(idle(start + 350ms), Still::Sharper) << "at once, this time";
    plan.drawn(Still::Sharper, 500, start + 400ms);
    EXPECT_EQ(idle(start + 500ms), Still::Trial);
    plan.drawn(Still::Trial, 0, start + 600ms);
    EXPECT_FALSE(idle(start + 1h));
}

TEST_F(StillPlanTest, AfterASharperOneThatLacksNothingComesTheFinalOne) {
    plan.begin(true, start);
    plan.lacked(start + 150ms);
    plan.lacked(start + 200ms);
    plan.drawn(Still::Sharper, 0, start + 250ms);
    EXPECT_EQ(idle(start + 250ms), Still::Final);
    plan.ordered(Still::Final);
    EXPECT_FALSE(idle(start + 1h));
}

/// How many stills come before the final one, of which each lacks what `missing` says.
template <class Missing>
int stillsOf(StillPlan& plan, StillPlan::Time now, const Missing& missing) {
    int stills = 0;
    plan.begin(true, now);
    for (int i = 0; i < 1000; ++i, now += 50ms) {
        const auto still = plan.due(false, false, now);
        if (still == Still::Final) return stills;
        if (still == Still::Trial) plan.lacked(now);
        if (still == Still::Sharper) plan.drawn(Still::Sharper, missing(stills++), now);
    }
    return -1;
}

TEST_F(StillPlanTest, WhatGetsNoSharperIsGivenUpSoon) {
    EXPECT_EQ(stillsOf(plan, start, [](int) { return 1000u; }), 5);
}

TEST_F(StillPlanTest, WhatGetsSharperForeverIsGivenUpLater) {
    EXPECT_EQ(stillsOf(plan, start, [](int stills) { return 1000u - unsigned(stills); }), 20);
}

TEST_F(StillPlanTest, AfterAFailureTheFinalOneIsTried) {
    plan.begin(true, start);
    plan.failed();
    EXPECT_FALSE(plan.due(true, true, start + 1s)) << "while one is still being made";
    EXPECT_EQ(idle(start + 1s), Still::Final);
}

}  // namespace
}  // namespace scancast
