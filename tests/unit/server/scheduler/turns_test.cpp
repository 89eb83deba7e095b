// The scheduler's policy by itself, in a time that the tests make: what it says is drawn next, and how what it
// is told ends. What it promises whatever happens is the simulation's to find out (tests/simulation).
#include "server/scheduler/turns.hpp"

#include <gtest/gtest.h>

#include "server/scheduler/outcome.hpp"
#include "server/scheduler/picture_bytes.hpp"

namespace scancast {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using End = Turns::End;

class TurnsTest : public ::testing::Test {
  protected:
    explicit TurnsTest(const TurnsOptions& options = {}) : turns(options) {}

    /// Orders tell themselves apart by their width, here and in what a test expects.
    static PictureOrder moving(int width) {
        PictureOrder order;
        order.view.width = width;
        order.view.height = 8;
        order.complete = false;
        return order;
    }
    static PictureOrder still(int width) {
        PictureOrder order = moving(width);
        order.complete = order.interruptible = true;
        return order;
    }
    static PictureOrder picture(int width, std::string client = {}) {
        PictureOrder order = moving(width);
        order.complete = true;
        order.client = std::move(client);
        return order;
    }
    static PictureOrder costing(PictureOrder order, double price) {
        order.price = price;
        return order;
    }
    static Turns::Requests one(PictureOrder order) {
        Turns::Requests list;
        list.emplace_back(std::move(order), PicturePromise());
        return list;
    }

    void place(Turns::ParticipantId mailbox, PictureOrder order) {
        Turns::Requests list = one(std::move(order));
        turns.place(mailbox, list, now, ended);
    }
    Turns::SnapshotId snapshot(PictureOrder order) {
        Turns::Requests list = one(std::move(order));
        return turns.snapshot(list, now).value_or(0);
    }
    /// Width of what is drawn next, to its end, in so many ms; 0 = nothing is.
    int draw(int ms = 10) { return drawTaken(turns.take(now), ms); }
    /// The same in a pause of what is being drawn.
    int drawWithin(int ms = 10) { return drawTaken(turns.takeWithin(now), ms); }
    int drawTaken(std::optional<Turns::Taken> taken, int ms) {
        if (!taken) return 0;
        const int width = (*taken)->order.view.width;
        now += milliseconds(ms);
        turns.drawn(*taken, now);
        encodeAll();
        return width;
    }
    Turns::Taken take() {
        auto taken = turns.take(now);
        EXPECT_TRUE(taken);
        return *taken;
    }
    void encodeAll() {
        for (const auto line : {Turns::Line::Frames, Turns::Line::Pictures})
            while (turns.hasToEncode(line)) turns.encoded(turns.toEncode(line), {}, now, ended);
    }
    std::vector<int> drawAll(int ms = 10) {
        std::vector<int> widths;
        while (const int width = draw(ms)) widths.push_back(width);
        return widths;
    }
    /// How the order of that width ended.
    End endOf(int width) const {
        for (const auto& request : ended)
            if (request.order.view.width == width) return request.end;
        return End::Open;
    }
    static Error stopped() { return cancelled(); }

    Turns turns;
    Turns::Time now{hours(1)};
    Turns::Requests ended;
};

TEST_F(TurnsTest, TheLatestRequestOfAMailboxWins) {
    const auto mailbox = turns.openMailbox();
    for (int i = 1; i <= 5; ++i) place(mailbox, moving(i));
    EXPECT_EQ(drawAll(), std::vector<int>{5});
    for (int i = 1; i <= 4; ++i) EXPECT_EQ(endOf(i), End::Overwritten);
    EXPECT_TRUE(turns.idle());
}

TEST_F(TurnsTest, ReplacingNeedsOneThatWaits) {
    const auto mailbox = turns.openMailbox();
    auto first = one(moving(1));
    EXPECT_FALSE(turns.replaceWaiting(mailbox, first, now, ended));
    place(mailbox, moving(2));
    const auto taken = take();
    EXPECT_FALSE(turns.replaceWaiting(mailbox, first, now, ended)) << "it is being drawn already";
    turns.drawn(taken, now);
    encodeAll();
    place(mailbox, moving(3));
    EXPECT_TRUE(turns.replaceWaiting(mailbox, first, now, ended));
    EXPECT_EQ(drawAll(), std::vector<int>{1});
    EXPECT_EQ(endOf(3), End::Overwritten);
}

// With everybody asking again and again at the same cost, nobody has two frames before all have one.
TEST_F(TurnsTest, ManySessionsAreServedInTurn) {
    constexpr int sessions = 9, rounds = 5;
    std::vector<Turns::ParticipantId> mailboxes;
    for (int s = 0; s < sessions; ++s) {
        mailboxes.push_back(turns.openMailbox());
        place(mailboxes.back(), moving(s + 1));
    }
    for (int turn = 0; turn < sessions * rounds; ++turn) {
        const int width = draw();
        EXPECT_EQ(width, turn % sessions + 1) << "turn " << turn;
        place(mailboxes[std::size_t(width - 1)], moving(width));
    }
}

TEST_F(TurnsTest, TheDeviceIsSharedByTimeAndNotByCount) {
    const auto slow = turns.openMailbox(), quick = turns.openMailbox();
    std::array<int, 2> frames{};
    place(slow, moving(1));
    place(quick, moving(2));
    for (int turn = 0; turn < 1000; ++turn) {
        const bool isSlow = turns.owed(slow) >= turns.owed(quick);
        const int width = draw(isSlow ? 90 : 10);
        ASSERT_EQ(width, isSlow ? 1 : 2);
        ++frames[std::size_t(width - 1)];
        place(width == 1 ? slow : quick, moving(width));
    }
    EXPECT_NEAR(frames[0] * 90, frames[1] * 10, 90);
}

TEST_F(TurnsTest, WhoAskedForNothingIsOwedNextToNothing) {
    const auto steady = turns.openMailbox(), other = turns.openMailbox();
    for (int i = 0; i < 100; ++i) {
        place(steady, moving(1));
        ASSERT_EQ(draw(50), 1);
    }
    // Five seconds later the other one comes, and asks as often: both get half from now on.
    int others = 0;
    place(steady, moving(1));
    place(other, moving(2));
    for (int i = 0; i < 20; ++i) {
        const int width = draw(50);
        others += width == 2;
        place(width == 1 ? steady : other, moving(width));
    }
    EXPECT_EQ(others, 10);
}

TEST_F(TurnsTest, SnapshotsOfOneClientAreOneParticipant) {
    const auto mailbox = turns.openMailbox();
    for (int i = 0; i < 5; ++i) snapshot(picture(10 + i, "greedy"));
    snapshot(picture(20, "modest"));
    place(mailbox, moving(99));
    EXPECT_EQ(drawAll(), (std::vector<int>{10, 20, 99, 11, 12, 13, 14}));
}

TEST_F(TurnsTest, TheSnapshotQueueIsBounded) {
    TurnsOptions options;
    options.maxSnapshots = 3;
    Turns bounded(options);
    for (int i = 1; i <= 5; ++i) {
        auto list = one(picture(i, std::to_string(i)));
        const auto queued = bounded.snapshot(list, now);
        EXPECT_EQ(queued.has_value(), i <= 3);
        if (!queued) {
            EXPECT_EQ(queued.error().code, ErrorCode::ResourceLimit);
            EXPECT_EQ(list.size(), 1U) << "it stays with who asked";
        }
    }
    bounded.take(now);
    auto list = one(picture(6));
    EXPECT_TRUE(bounded.snapshot(list, now)) << "one that is drawn waits no more";
}

TEST_F(TurnsTest, StillsWaitUntilNobodyMoves) {
    for (int i = 2; i <= 4; ++i) place(turns.openMailbox(), still(i));
    for (int i = 5; i <= 7; ++i) place(turns.openMailbox(), moving(i));
    EXPECT_EQ(drawAll(), (std::vector<int>{5, 6, 7, 2, 3, 4}));
}

TEST_F(TurnsTest, AStillThatHasWaitedLongTakesItsTurn) {
    const auto looker = turns.openMailbox(), mover = turns.openMailbox();
    place(looker, still(1));
    std::vector<int> widths;
    for (int i = 0; i < 300 && endOf(1) == End::Open; ++i) {
        place(mover, moving(2));
        widths.push_back(draw());
    }
    EXPECT_EQ(endOf(1), End::Done);
    EXPECT_EQ(widths.size(), 201U) << "two seconds of frames of 10 ms";
}

TEST_F(TurnsTest, WhereNothingPausesAStillIsStoppedForAMovingFrame) {
    const auto looker = turns.openMailbox(), mover = turns.openMailbox();
    place(looker, still(1));
    const auto taken = take();
    place(mover, moving(2));
    ASSERT_TRUE(taken->stop.stop_requested());
    turns.failed(taken, stopped(), now, ended);
    EXPECT_EQ(drawAll(), (std::vector<int>{2, 1})) << "it is begun again, and not lost";
    EXPECT_EQ(endOf(1), End::Done);

    place(looker, still(3));
    const auto again = take();
    place(mover, moving(4));
    place(looker, moving(5));
    turns.failed(again, stopped(), now, ended);
    EXPECT_EQ(drawAll(), (std::vector<int>{4, 5}));
    EXPECT_EQ(endOf(3), End::Abandoned) << "its session wants another";
}

TEST_F(TurnsTest, MovingFramesAndStillsThatHaveWaitedLongAreNotStopped) {
    const auto mine = turns.openMailbox(), other = turns.openMailbox();
    place(mine, moving(1));
    const auto frame = take();
    place(mine, moving(2));
    place(other, moving(3));
    EXPECT_FALSE(frame->stop.stop_requested());
    turns.drawn(frame, now);
    drawAll();
    place(mine, still(4));
    now += milliseconds(2001);
    const auto patient = take();
    place(other, moving(5));
    EXPECT_FALSE(patient->stop.stop_requested());
    place(mine, moving(6));
    EXPECT_TRUE(patient->stop.stop_requested()) << "by a newer request of its own session";
    turns.failed(patient, stopped(), now, ended);
    EXPECT_EQ(endOf(4), End::Abandoned);
}

TEST_F(TurnsTest, MovingFramesAreDrawnWithinAStillAndASnapshot) {
    turns.setPauses(true);
    const auto looker = turns.openMailbox(), mover = turns.openMailbox();
    place(looker, still(1));
    const auto taken = take();
    now += milliseconds(10);
    EXPECT_EQ(drawWithin(), 0) << "nobody asks";
    for (int i = 0; i < 10; ++i) {
        place(mover, moving(2));
        EXPECT_FALSE(taken->stop.stop_requested());
        EXPECT_EQ(drawWithin(), 2) << "however much it has had: the still gives way";
    }
    turns.drawn(taken, now);
    encodeAll();
    EXPECT_EQ(endOf(1), End::Done);

    // A snapshot gives no way: they share.
    const auto another = turns.openMailbox();
    snapshot(picture(3));
    const auto shared = take();
    int within = 0;
    for (int slice = 0; slice < 100; ++slice) {
        now += milliseconds(10);
        place(another, moving(4));
        while (drawWithin(20) == 4) {
            ++within;
            place(another, moving(4));
        }
    }
    EXPECT_NEAR(within, 50, 2) << "as much time as the snapshot";
    turns.drawn(shared, now);
}

TEST_F(TurnsTest, WhatCostsAQuarterIsDrawnWithinAndTheRestWaits) {
    turns.setPauses(true);
    snapshot(costing(picture(1, "a"), 4000));
    const auto outer = take();
    now += milliseconds(10);
    snapshot(costing(picture(2, "b"), 1001));
    EXPECT_EQ(turns.takeWithin(now), std::nullopt);
    snapshot(costing(picture(3, "c"), 1000));
    const auto middle = turns.takeWithin(now);
    ASSERT_TRUE(middle);
    EXPECT_EQ((*middle)->order.view.width, 3);
    now += milliseconds(10);
    snapshot(costing(picture(4, "d"), 250));
    EXPECT_EQ(drawWithin(), 4);
    snapshot(costing(picture(5, "c"), 1));
    EXPECT_EQ(drawWithin(), 0) << "its client's own picture is being drawn";
    turns.drawn(*middle, now);
    turns.drawn(outer, now);
    encodeAll();
    EXPECT_EQ(drawAll(), (std::vector<int>{2, 5}));
}

TEST_F(TurnsTest, AsManyAreWithinEachOtherAsBuffersAreKeptFor) {
    turns.setPauses(true);
    double price = 1e6;
    for (int i = 0; i < 10; ++i, price /= 10) snapshot(costing(picture(i + 1, std::to_string(i)), price));
    take();
    while (turns.takeWithin(now)) {
    }
    EXPECT_EQ(turns.depth(), 4U);
}

TEST_F(TurnsTest, WhatIsToEndLetsNobodyIn) {
    turns.setPauses(true);
    const auto looker = turns.openMailbox(), mover = turns.openMailbox();
    place(looker, still(1));
    const auto taken = take();
    place(mover, moving(2));
    turns.closeMailbox(looker, ended);
    EXPECT_TRUE(taken->stop.stop_requested());
    EXPECT_EQ(turns.takeWithin(now), std::nullopt);
    turns.failed(taken, stopped(), now, ended);
    EXPECT_EQ(endOf(1), End::Gone);
    EXPECT_EQ(drawAll(), std::vector<int>{2});
}

TEST_F(TurnsTest, AnAbandonedSnapshotEndsWhereverItIs) {
    const auto waits = snapshot(picture(1)), drawn = snapshot(picture(2, "b"));
    turns.abandonSnapshot(waits, ended);
    EXPECT_EQ(endOf(1), End::Gone);
    const auto taken = take();
    turns.abandonSnapshot(drawn, ended);
    EXPECT_TRUE(taken->stop.stop_requested());
    turns.failed(taken, stopped(), now, ended);
    EXPECT_EQ(endOf(2), End::Gone);

    const auto aside = snapshot(picture(3));
    turns.lacksBlocks(take(), now, ended);
    turns.abandonSnapshot(aside, ended);
    EXPECT_EQ(endOf(3), End::Gone);
    const auto preparing = snapshot(picture(4));
    turns.lacksBlocks(take(), now, ended);
    const auto prepares = turns.takeToPrepare(now);
    turns.abandonSnapshot(preparing, ended);
    EXPECT_TRUE((*prepares)->stop.stop_requested());
    turns.blocksFailed(*prepares, stopped(), now, ended);
    EXPECT_EQ(endOf(4), End::Gone);
    EXPECT_TRUE(turns.idle());
}

TEST_F(TurnsTest, DeadlinesEndSnapshotsWhereverTheyAre) {
    snapshot(picture(1, "a"));
    snapshot(picture(2, "b"));
    snapshot(picture(3, "c"));
    const auto runs = take();
    turns.letGo(runs, now);
    turns.lacksBlocks(take(), now, ended);
    EXPECT_EQ(turns.nextTime(), now + milliseconds(30000));
    now = turns.nextTime();
    turns.passTime(now, ended);
    EXPECT_EQ(endOf(2), End::Late);
    EXPECT_EQ(endOf(3), End::Late);
    EXPECT_TRUE(runs->stop.stop_requested());
    turns.resume(runs, now);
    turns.failed(runs, stopped(), now, ended);
    EXPECT_EQ(endOf(1), End::Late);
    EXPECT_EQ(turns.nextTime(), Turns::Time::max());
}

TEST_F(TurnsTest, OnesDiskThatStallsIsNotEverybodys) {
    const auto a = turns.openMailbox(), b = turns.openMailbox();
    place(a, still(1));
    turns.lacksBlocks(take(), now, ended);
    const auto stalls = turns.takeToPrepare(now);
    EXPECT_EQ(turns.nextTime(), Turns::Time::max()) << "it has its time while nobody else waits";
    now += milliseconds(5000);
    place(b, still(2));
    turns.lacksBlocks(take(), now, ended);
    ASSERT_LE(turns.nextTime(), now);
    turns.passTime(now, ended);
    ASSERT_TRUE((*stalls)->stop.stop_requested());
    turns.blocksFailed(*stalls, stopped(), now, ended);
    const auto next = turns.takeToPrepare(now);
    ASSERT_EQ((*next)->order.view.width, 2);
    EXPECT_EQ(turns.nextTime(), now + milliseconds(2 * 5000 + 250)) << "now it has longer than the other had";
    (*next)->prepared.emplace();
    turns.blocksCame(*next, now, ended);
    EXPECT_EQ(draw(), 2);
    const auto again = turns.takeToPrepare(now);
    ASSERT_EQ((*again)->order.view.width, 1) << "and is not lost";
    (*again)->prepared.emplace();
    turns.blocksCame(*again, now, ended);
    EXPECT_EQ(draw(), 1);
}

TEST_F(TurnsTest, ANewRequestEndsTheStillOfItsMailboxWhereverItIs) {
    const auto mailbox = turns.openMailbox();
    place(mailbox, still(1));
    turns.lacksBlocks(take(), now, ended);
    place(mailbox, moving(2));
    EXPECT_EQ(endOf(1), End::Abandoned) << "aside";
    draw();
    place(mailbox, still(3));
    turns.lacksBlocks(take(), now, ended);
    const auto prepares = turns.takeToPrepare(now);
    (*prepares)->prepared.emplace();
    turns.blocksCame(*prepares, now, ended);
    place(mailbox, moving(4));
    EXPECT_EQ(endOf(3), End::Abandoned) << "with its samples";
    EXPECT_EQ(drawAll(), std::vector<int>{4});
    EXPECT_TRUE(turns.idle());
}

TEST_F(TurnsTest, APictureTellsHowManySharedTheTime) {
    for (int i = 1; i <= 4; ++i) place(turns.openMailbox(), moving(i));
    place(turns.openMailbox(), still(5));
    snapshot(picture(6));
    EXPECT_EQ(take()->rivals, 4U) << "the still is none: it gives way";
}

TEST_F(TurnsTest, NoMoreIsDrawnThanIsEncoded) {
    turns.setPauses(true);
    std::vector<Turns::ParticipantId> movers;
    for (int i = 1; i <= 5; ++i) place(turns.openMailbox(), moving(i));
    for (int i = 0; i < 2; ++i) turns.drawn(take(), now);
    EXPECT_FALSE(turns.hasTurn());
    snapshot(picture(6));
    ASSERT_TRUE(turns.hasTurn()) << "its encoder is another one";
    const auto large = take();
    EXPECT_EQ(large->order.view.width, 6);
    turns.encoded(turns.toEncode(Turns::Line::Frames), {}, now, ended);
    EXPECT_EQ(drawWithin(), 3);
}

TEST_F(TurnsTest, ClientsOfLongAgoAreForgotten) {
    snapshot(picture(1, "a"));
    draw(1000);
    snapshot(picture(2, "b"));
    draw(10);
    snapshot(picture(3, "b"));
    EXPECT_EQ(turns.owed(1).count(), 0) << "nobody else asked meanwhile";
    EXPECT_EQ(draw(), 3);
}

TEST_F(TurnsTest, TheEndEndsEverythingOnce) {
    const auto a = turns.openMailbox(), b = turns.openMailbox();
    place(a, still(1));
    turns.lacksBlocks(take(), now, ended);
    const auto prepares = turns.takeToPrepare(now);
    place(b, still(2));
    turns.lacksBlocks(take(), now, ended);
    snapshot(picture(3));
    const auto draws = take();
    place(a, moving(4));
    snapshot(picture(5));
    turns.stop(ended);
    EXPECT_EQ(endOf(2), End::Gone);
    EXPECT_EQ(endOf(4), End::Gone);
    EXPECT_EQ(endOf(5), End::Gone);
    turns.blocksFailed(*prepares, stopped(), now, ended);
    turns.failed(draws, stopped(), now, ended);
    EXPECT_EQ(endOf(1), End::Abandoned) << "a newer one of its session had come before";
    EXPECT_EQ(endOf(3), End::Gone);
    place(a, moving(6));
    EXPECT_EQ(endOf(6), End::Refused);
    EXPECT_EQ(ended.size(), 6U);
    EXPECT_TRUE(turns.idle());
}

/// With memory for one picture of a width of 1000, and a half.
class TightTurnsTest : public TurnsTest {
  protected:
    TightTurnsTest() : TurnsTest(tight()) {}
    static TurnsOptions tight() {
        TurnsOptions options;
        options.maxFrameBytes = bytesToDraw(picture(1000).view, PictureFormat::Jpeg) * 3 / 2;
        return options;
    }
};

TEST_F(TightTurnsTest, DepthThatComesWithAPictureTakesMemoryToo) {
    PictureOrder order = picture(1000, "a");
    const std::uint64_t without = bytesToDraw(order),
                        pixels = std::uint64_t(1000) * std::uint64_t(order.view.height);
    order.withDepth = true;
    EXPECT_EQ(bytesToDraw(order), without + pixels * sizeof(float));
    order.format = PictureFormat::Depth;
    EXPECT_EQ(bytesToDraw(order), bytesToDraw(order.view, PictureFormat::Depth)) << "there is one depth";
}

TEST_F(TightTurnsTest, StillsAndSnapshotsWaitForMemoryAndMovingFramesDoNot) {
    turns.setPauses(true);
    snapshot(picture(1000, "a"));
    const Turns::Taken large = take();
    turns.letGo(large, now);
    snapshot(picture(1001, "b"));
    EXPECT_FALSE(turns.hasTurn()) << "together they are too large";
    EXPECT_EQ(draw(), 0);
    const auto mover = turns.openMailbox();
    place(mover, moving(4000));
    EXPECT_TRUE(turns.hasTurn());
    EXPECT_EQ(draw(), 4000);
    snapshot(picture(400, "c"));
    EXPECT_TRUE(turns.hasTurn());
    EXPECT_EQ(draw(), 400) << "there is room for a small one";
    EXPECT_FALSE(turns.hasTurn());
    turns.resume(large, now);
    turns.drawn(large, now);
    EXPECT_FALSE(turns.hasTurn()) << "it is still to be encoded";
    EXPECT_GT(turns.frameBytes(), 0u);
    encodeAll();
    EXPECT_EQ(turns.frameBytes(), 0u);
    EXPECT_EQ(draw(), 1001);
}

TEST_F(TightTurnsTest, OneThatIsLargerThanAllMemoryIsDrawnAlone) {
    snapshot(picture(2000));
    snapshot(picture(3000));
    EXPECT_EQ(drawAll(), (std::vector<int>{2000, 3000}));
}

}  // namespace
}  // namespace scancast
