#include "server/stream/still_schedule.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

using namespace std::chrono_literals;
using Still = StillSchedule::Still;

class StillPlanTest : public testing::Test {
  protected:
    const StillSchedule::Time start{};
    StillSchedule schedule{StillTimes{150ms, 50ms, 100ms}};

    std::optional<Still> idle(StillSchedule::Time now) const { return schedule.due(false, false, now); }
};

TEST_F(StillPlanTest, NothingIsDueWithoutAView) {
    EXPECT_FALSE(idle(start + 1h));
    EXPECT_FALSE(schedule.dueAt(false));
}

TEST_F(StillPlanTest, OfAViewThatLacksNothingTheFinalOneComesAfterTheQuiet) {
    schedule.begin(false, start);
    EXPECT_EQ(schedule.dueAt(false), start + 150ms);
    EXPECT_FALSE(idle(start + 149ms));
    EXPECT_EQ(idle(start + 150ms), Still::Final);
    schedule.ordered(Still::Final);
    EXPECT_FALSE(idle(start + 1h));
}

TEST_F(StillPlanTest, AFinalOneWhoseBlocksCannotBeHadNowIsOrderedAgainLater) {
    schedule.begin(true, start);
    schedule.ordered(Still::Final);
    schedule.saidAway();
    schedule.away(start + 1s);
    EXPECT_FALSE(idle(start + 2999ms));
    EXPECT_EQ(idle(start + 3s), Still::Final);
    schedule.ordered(Still::Final);
    EXPECT_FALSE(idle(start + 1h));
    schedule.away(start + 4s);
    schedule.begin(false, start + 5s);
    EXPECT_EQ(idle(start + 5150ms), Still::Final) << "another view does not wait for that";
}

TEST_F(StillPlanTest, WhereNoPictureHasSaidThatBlocksCannotBeHadOneDoesSoAtOnce) {
    schedule.begin(true, start);
    schedule.ordered(Still::Final);
    schedule.away(start + 1s);
    EXPECT_EQ(idle(start + 1s), Still::Sharper);
    schedule.ordered(Still::Sharper);
    schedule.drawn(Still::Sharper, 500, start + 1s);
    EXPECT_EQ(idle(start + 1s), Still::Final) << "it may be back";
    schedule.ordered(Still::Final);
    schedule.away(start + 2s);
    EXPECT_FALSE(idle(start + 3999ms)) << "once for each view, whatever that picture said";
    EXPECT_EQ(idle(start + 4s), Still::Final);
}

TEST_F(StillPlanTest, AnotherViewBeginsAnew) {
    schedule.begin(false, start);
    schedule.ordered(Still::Final);
    schedule.begin(false, start + 200ms);
    EXPECT_FALSE(idle(start + 300ms));
    EXPECT_EQ(idle(start + 350ms), Still::Final);
}

TEST_F(StillPlanTest, ATrialThatIsDrawnIsTheFinalOne) {
    schedule.begin(true, start);
    EXPECT_EQ(idle(start + 150ms), Still::Trial);
    schedule.ordered(Still::Trial);
    EXPECT_FALSE(schedule.due(true, true, start + 1s)) << "one after the other";
    schedule.drawn(Still::Trial, 0, start + 200ms);
    EXPECT_FALSE(idle(start + 1h));
}

TEST_F(StillPlanTest, WhatIsADiskAwayIsTriedAgainSoon) {
    schedule.begin(true, start);
    schedule.lacked(start + 150ms);
    EXPECT_FALSE(idle(start + 199ms));
    EXPECT_EQ(idle(start + 200ms), Still::Trial);
    schedule.lacked(start + 200ms);
    EXPECT_EQ(idle(start + 200ms), Still::Sharper);
}

TEST_F(StillPlanTest, StillsGetSharperUntilATrialFindsEverything) {
    schedule.begin(true, start);
    schedule.lacked(start + 150ms);
    schedule.lacked(start + 200ms);
    schedule.drawn(Still::Sharper, 1000, start + 250ms);
    EXPECT_FALSE(idle(start + 349ms));
    EXPECT_EQ(idle(start + 350ms), Still::Trial);
    schedule.lacked(start + 350ms);
    EXPECT_EQ(idle(start + 350ms), Still::Sharper) << "at once, this time";
    schedule.drawn(Still::Sharper, 500, start + 400ms);
    EXPECT_EQ(idle(start + 500ms), Still::Trial);
    schedule.drawn(Still::Trial, 0, start + 600ms);
    EXPECT_FALSE(idle(start + 1h));
}

TEST_F(StillPlanTest, AfterASharperOneThatLacksNothingComesTheFinalOne) {
    schedule.begin(true, start);
    schedule.lacked(start + 150ms);
    schedule.lacked(start + 200ms);
    schedule.drawn(Still::Sharper, 0, start + 250ms);
    EXPECT_EQ(idle(start + 250ms), Still::Final);
    schedule.ordered(Still::Final);
    EXPECT_FALSE(idle(start + 1h));
}

/// How many stills come before the final one, of which each lacks what `missing` says.
template <class Missing>
int stillsOf(StillSchedule& schedule, StillSchedule::Time now, const Missing& missing) {
    int stills = 0;
    schedule.begin(true, now);
    for (int i = 0; i < 1000; ++i, now += 50ms) {
        const auto still = schedule.due(false, false, now);
        if (still == Still::Final) return stills;
        if (still == Still::Trial) schedule.lacked(now);
        if (still == Still::Sharper) schedule.drawn(Still::Sharper, missing(stills++), now);
    }
    return -1;
}

TEST_F(StillPlanTest, WhatGetsNoSharperIsGivenUpSoon) {
    EXPECT_EQ(stillsOf(schedule, start, [](int) { return 1000u; }), 5);
}

TEST_F(StillPlanTest, WhatGetsSharperForeverIsGivenUpLater) {
    EXPECT_EQ(stillsOf(schedule, start, [](int stills) { return 1000u - unsigned(stills); }), 20);
}

TEST_F(StillPlanTest, AfterAFailureTheFinalOneIsTried) {
    schedule.begin(true, start);
    schedule.failed();
    EXPECT_FALSE(schedule.due(true, true, start + 1s)) << "while one is still being made";
    EXPECT_EQ(idle(start + 1s), Still::Final);
}

}  // namespace
}  // namespace scancast
