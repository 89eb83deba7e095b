// What a session shows of clouds that are not in memory, or not complete yet.
#include "tests/unit/server/stream/session_fixture.hpp"

namespace scancast::test {
namespace {

class ColdCloud : public SessionTest {
  protected:
    void SetUp() override { world.first = coldCloud(); }
    /// Two trials find that something is missing.
    void tryTwice() {
        for (const int ms : {150, 50}) {
            pass(ms);
            ASSERT_TRUE(port.orders.back().order.onlyWhole);
            refuse(port.orders.size() - 1);
        }
    }
    void refuse(std::size_t n) {
        session->pictureDone(port.orders.at(n).number, fail(ErrorCode::Cancelled, "still to be read"), now);
    }
    void finishMissing(std::size_t n, std::uint64_t missing, std::uint32_t damaged = 0) {
        EncodedPicture picture;
        picture.bytes = std::make_shared<const Bytes>(Bytes{1, 2, 3});
        picture.width = picture.height = 8;
        picture.stats.samplesMissing = missing;
        picture.stats.nodesDamaged = damaged;
        session->pictureDone(port.orders.at(n).number, std::move(picture), now);
        ack(port.frames.back().frameId);
    }
};

TEST_F(ColdCloud, WhatIsInMemoryAfterAllIsTheFinalStill) {
    hello();
    pass(150);
    ASSERT_EQ(port.orders.size(), 1U);
    EXPECT_TRUE(order(0).onlyWhole);
    EXPECT_FALSE(order(0).complete) << "it does not wait";
    EXPECT_TRUE(order(0).interruptible);
    EXPECT_FALSE(order(0).view.quality.samples) << "as good as the final one";
    refuse(0);
    EXPECT_EQ(port.orders.size(), 1U) << "a disk takes some time";
    pass(50);
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_TRUE(order(1).onlyWhole);
    finishMissing(1, 0);
    ASSERT_EQ(port.frames.size(), 1U);
    EXPECT_TRUE(port.frames[0].still && port.frames[0].final);
    pass(10'000);
    EXPECT_EQ(port.orders.size(), 2U) << "after the final still nothing is sent";
    EXPECT_FALSE(session->wakeAt());
}

TEST_F(ColdCloud, WhatLacksOnlyDamagedBlocksIsTheEndAndSaysSo) {
    hello();
    tryTwice();
    finishMissing(2, 500, 3);
    ASSERT_EQ(port.frames.size(), 1U);
    EXPECT_FALSE(port.frames[0].final || port.frames[0].damaged) << "something is still to come";
    pass(100);
    finishMissing(3, 0, 3);
    ASSERT_EQ(port.frames.size(), 2U);
    EXPECT_TRUE(port.frames[1].still && port.frames[1].final && port.frames[1].damaged);
    pass(10'000);
    EXPECT_EQ(port.orders.size(), 4U);
    EXPECT_FALSE(session->wakeAt());
    view(1, 10);
    finishMissing(4, 0, 3);
    EXPECT_TRUE(port.frames[2].moving);
    EXPECT_FALSE(port.frames[2].damaged) << "nobody ends with a moving frame";
}

TEST_F(ColdCloud, AFrameThatIsCoarserBecauseAPartOfTheServerIsAwaySaysSo) {
    hello();
    tryTwice();
    finishMissing(2, 500);
    ASSERT_EQ(port.frames.size(), 1U);
    EXPECT_FALSE(port.frames[0].away) << "nobody knows yet";
    pass(100);
    for (std::size_t n = 3; !order(n).complete; ++n) {
        if (order(n).onlyWhole)
            refuse(n);
        else
            finishMissing(n, 500);
        pass(100);
    }
    const std::size_t final = port.orders.size() - 1, before = port.frames.size();
    session->pictureDone(port.orders[final].number, fail(ErrorCode::Unavailable, "away"), now);
    ASSERT_EQ(port.orders.size(), final + 2) << "at once";
    EXPECT_EQ(order(final + 1).view.quality.samples, 1);
    EncodedPicture coarser;
    coarser.bytes = std::make_shared<const Bytes>(Bytes{1, 2, 3});
    coarser.width = coarser.height = 8;
    coarser.stats.samplesMissing = 500;
    coarser.stats.away = true;
    session->pictureDone(port.orders[final + 1].number, std::move(coarser), now);
    ASSERT_EQ(port.frames.size(), before + 1);
    EXPECT_TRUE(port.frames.back().away && port.frames.back().still && !port.frames.back().final);
    ack(port.frames.back().frameId);
    ASSERT_EQ(port.orders.size(), final + 3);
    EXPECT_TRUE(order(final + 2).complete);
    session->pictureDone(port.orders[final + 2].number, fail(ErrorCode::Unavailable, "away"), now);
    EXPECT_EQ(port.orders.size(), final + 3) << "from now on at leisure";
    pass(2000);
    ASSERT_EQ(port.orders.size(), final + 4);
    finishMissing(final + 3, 0);
    EXPECT_TRUE(port.frames.back().final && !port.frames.back().away) << "it is back";
}

TEST_F(ColdCloud, StillsGetSharperUntilNothingIsMissingThenComesTheFinalOne) {
    hello();
    tryTwice();
    ASSERT_EQ(port.orders.size(), 3U);
    EXPECT_FALSE(order(2).complete || order(2).onlyWhole);
    EXPECT_TRUE(order(2).interruptible);
    EXPECT_EQ(order(2).view.quality.samples, 1);
    finishMissing(2, 500);
    EXPECT_EQ(port.orders.size(), 3U) << "not at once: blocks take time";
    EXPECT_TRUE(session->wakeAt());
    pass(100);
    ASSERT_EQ(port.orders.size(), 4U);
    refuse(3);
    finishMissing(4, 0);
    ASSERT_EQ(port.orders.size(), 6U) << "complete: the final one follows without a pause";
    EXPECT_TRUE(order(5).complete);
    EXPECT_FALSE(order(5).view.quality.samples);
    finishMissing(5, 0);
    ASSERT_EQ(port.frames.size(), 3U);
    EXPECT_TRUE(port.frames[0].still && !port.frames[0].final && !port.frames[0].moving);
    EXPECT_TRUE(port.frames[2].still && port.frames[2].final);
    pass(10'000);
    EXPECT_EQ(port.orders.size(), 6U) << "after the final still nothing is sent";
    EXPECT_FALSE(session->wakeAt());
}

TEST_F(ColdCloud, StillsWithoutProgressEndInTheFinalOneThatWaits) {
    hello();
    pass(150);
    for (std::size_t n = 0; n < 100 && !order(n).complete; ++n) {
        if (order(n).onlyWhole)
            refuse(n);
        else
            finishMissing(n, 500);
        pass(100);
        ASSERT_EQ(port.orders.size(), n + 2);
    }
    EXPECT_TRUE(port.orders.back().order.complete);
    EXPECT_LT(port.orders.size(), 15U);
}

TEST_F(ColdCloud, AFailedStillIsNotTriedForEver) {
    hello();
    pass(150);
    session->pictureDone(port.orders[0].number, fail(ErrorCode::Internal, "broken"), now);
    ASSERT_EQ(port.orders.size(), 2U);
    session->pictureDone(port.orders[1].number, fail(ErrorCode::Internal, "broken"), now);
    pass(1000);
    EXPECT_EQ(port.orders.size(), 2U);
}

TEST_F(ColdCloud, ANewViewEndsTheStills) {
    hello();
    pass(150);
    view(1, 10);
    EXPECT_EQ(port.abandoned, 1);
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_FALSE(order(1).complete);
    EXPECT_FALSE(order(1).interruptible);
}

TEST_F(ColdCloud, MovingFramesLookAhead) {
    hello();
    pass(100);
    view(1, 10);
    now += milliseconds(100);
    view(2, 12);
    ASSERT_GE(port.orders.size(), 2U);
    const auto ahead = order(1).ahead;
    ASSERT_TRUE(ahead);
    EXPECT_GT(ahead->eye.x, 14) << "0.3 s on, at 2 in 0.1 s";
}

TEST_F(SessionTest, AFinalStillThatFailsIsSaidAndTheNextViewHasItsOwn) {
    greet();
    view(5, 1);
    finish(0);
    ack(2);
    pass(150);
    session->pictureDone(port.orders.at(1).number, fail(ErrorCode::Internal, "broken"), now);
    ASSERT_EQ(port.texts.size(), 1U);
    EXPECT_EQ(port.texts[0]["type"], "problem");
    EXPECT_EQ(port.texts[0]["seq"], 5);
    pass(10'000);
    EXPECT_EQ(port.orders.size(), 2U) << "not tried for ever";
    view(6, 2);
    finish(2);
    ack(3);
    pass(150);
    finish(3);
    EXPECT_TRUE(port.frames.back().final);
    EXPECT_EQ(port.frames.back().seq, 6U);
}

TEST_F(SessionTest, WhoStandsStillSeesTheFinerCloudThatTakesThePlaceOfTheCoarse) {
    world.isLoading = true;
    hello();
    pass(150);
    finish(0);
    ack(1);
    ASSERT_TRUE(session->wakeAt()) << "a cloud that is being loaded is looked after";
    pass(250);
    EXPECT_EQ(port.orders.size(), 1U) << "it is still the same";
    const auto finer = tinyCloud(77);
    world.first = finer;
    world.isLoading = false;
    pass(250);
    pass(150);
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_EQ(order(1).cloud, finer);
    EXPECT_TRUE(order(1).complete);
    finish(1);
    ack(2);
    EXPECT_FALSE(session->wakeAt()) << "loaded: nothing more to look for";
}

}  // namespace
}  // namespace scancast::test
