// Pictures whose pixels come late, as a GPU's do: the next is begun meanwhile, and nothing else changes.
#include <algorithm>
#include <future>

#include "tests/unit/server/scheduler/scheduler_fixture.hpp"

namespace scancast {
namespace {

using test::FakePainter;

class PendingFrames : public test::SchedulerTest {
  protected:
    PendingFrames() { painter.finishLate(); }

    /// The device opens when letIn() is called: until then requests can gather.
    OpenPainter openLater() {
        return [this, in = in_.get_future().share()] {
            in.wait();
            return painter.open()();
        };
    }
    void letIn() { in_.set_value(); }

  private:
    std::promise<void> in_;
};

TEST_F(PendingFrames, TheNextIsBegunBeforeThePixelsOfTheOneBeforeAreThere) {
    painter.closeGate();
    Scheduler scheduler(openLater(), {}, metrics);
    for (int i = 1; i <= 4; ++i) scheduler.request(scheduler.openMailbox(), moving(i), results.collect(i));
    letIn();
    ASSERT_TRUE(painter.waitBegun(2)) << "while no pixel of the first gets through";
    for (std::size_t i = 1; i <= 4; ++i) {
        painter.let(1);
        ASSERT_TRUE(results.waitFor(i));
    }
    EXPECT_EQ(results.labels(), (std::vector<int>{1, 2, 3, 4}));
    EXPECT_EQ(begunWidths(), (std::vector<int>{1, 2, 3, 4}));
    EXPECT_EQ(painter.mostAtOnce(), 2) << "one on its way, one being begun";
}

TEST_F(PendingFrames, APictureThatMayTakeLongIsBegunOnlyAfterThem) {
    painter.closeGate();
    Scheduler scheduler(openLater(), {}, metrics);
    const auto a = scheduler.openMailbox(), b = scheduler.openMailbox();
    scheduler.request(a, moving(1), results.collect(1));
    scheduler.request(b, order(2, true), results.collect(2));
    letIn();
    painter.let(1);
    ASSERT_TRUE(results.waitFor(1));
    ASSERT_TRUE(painter.waitBegun(2));
    painter.let(1);
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(painter.mostAtOnce(), 1);
}

TEST_F(PendingFrames, AFrameIsNotHeldBackUntilSomebodyAsksAgain) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    for (int i = 1; i <= 3; ++i) {
        scheduler.request(mailbox, order(i), results.collect(i));
        ASSERT_TRUE(painter.waitBegun(std::size_t(i)));
        painter.let(1);
        ASSERT_TRUE(results.waitFor(std::size_t(i)));
        EXPECT_EQ(results.code(i), std::nullopt);
    }
}

TEST_F(PendingFrames, ANewViewStopsTheSessionsOwnStillOnItsWay) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(1, true), results.collect(1));
    ASSERT_TRUE(painter.waitBegun(1));
    scheduler.request(mailbox, order(2), results.collect(2));
    ASSERT_TRUE(results.waitFor(1)) << "the gate is closed, so the still can only have been stopped";
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    painter.openGate();
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(2), std::nullopt);
    EXPECT_EQ(metric("scancast_frames_dropped_total{reason=\"abandoned\"}"),
              "scancast_frames_dropped_total{reason=\"abandoned\"} 1");
}

TEST_F(PendingFrames, AClosedMailboxStopsEvenAMovingFrameOnItsWay) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(1), results.collect(1));
    ASSERT_TRUE(painter.waitBegun(1));
    scheduler.closeMailbox(mailbox);
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    EXPECT_EQ(metric("scancast_frames_dropped_total{reason=\"gone\"}"),
              "scancast_frames_dropped_total{reason=\"gone\"} 1");
}

TEST_F(PendingFrames, OfTwoOnTheirWayEachIsStoppedByItsOwnSession) {
    painter.closeGate();
    SchedulerOptions options;
    options.stillPatience = std::chrono::milliseconds(0);
    Scheduler scheduler(openLater(), options, metrics);
    const auto a = scheduler.openMailbox(), b = scheduler.openMailbox();
    scheduler.request(a, order(1, true), results.collect(1));
    scheduler.request(b, moving(2), results.collect(2));
    letIn();
    ASSERT_TRUE(painter.waitBegun(2));
    scheduler.closeMailbox(b);
    scheduler.request(a, moving(3), results.collect(3));
    ASSERT_TRUE(results.waitFor(2)) << "the gate is closed, so both can only have been stopped";
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    EXPECT_EQ(results.code(2), ErrorCode::Cancelled);
    painter.openGate();
    ASSERT_TRUE(results.waitFor(3));
    EXPECT_EQ(results.code(3), std::nullopt);
    for (const char* reason : {"gone", "abandoned"}) {
        const std::string line = std::string("scancast_frames_dropped_total{reason=\"") + reason + "\"}";
        EXPECT_EQ(metric(line), line + " 1");
    }
}

TEST_F(PendingFrames, DeadlinesEndThemToo) {
    painter.closeGate();
    SchedulerOptions options;
    options.snapshotDeadline = std::chrono::milliseconds(50);
    Scheduler scheduler(painter.open(), options, metrics);
    for (int i = 1; i <= 3; ++i) ASSERT_TRUE(scheduler.snapshot(order(i), results.collect(i)));
    ASSERT_TRUE(results.waitFor(3));
    for (int i = 1; i <= 3; ++i) EXPECT_EQ(results.code(i), ErrorCode::DeadlineExceeded) << i;
}

TEST_F(PendingFrames, AnErrorThatComesWithThePixelsFailsOnePictureOnly) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    painter.failWith(Error{ErrorCode::ResourceLimit, "The GPU has no memory left.", {}});
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    painter.let(1);
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), ErrorCode::ResourceLimit);
    painter.failWith(std::nullopt);
    painter.openGate();
    ASSERT_TRUE(scheduler.snapshot(order(2), results.collect(2)));
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(2), std::nullopt);
}

TEST_F(PendingFrames, TheEndComesWhileOneIsOnItsWay) {
    painter.closeGate();
    {
        Scheduler scheduler(openLater(), {}, metrics);
        for (int i = 0; i < 5; ++i)
            scheduler.request(scheduler.openMailbox(), moving(i + 1), results.collect(i));
        letIn();
        ASSERT_TRUE(painter.waitBegun(2));
        scheduler.stop();
    }
    auto labels = results.labels();
    std::sort(labels.begin(), labels.end());
    EXPECT_EQ(labels, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST_F(PendingFrames, ManyThreadsAtOnce) {
    Scheduler scheduler(painter.open(), {}, metrics);
    constexpr int threads = 4, each = 200;
    std::vector<std::thread> crowd;
    for (int t = 0; t < threads; ++t) {
        crowd.emplace_back([&, t] {
            const auto mailbox = scheduler.openMailbox();
            for (int i = 0; i < each; ++i) {
                if (t == 0 && i % 20 == 0) painter.closeGate();
                if (t == 0 && i % 20 == 10) painter.openGate();
                scheduler.request(mailbox, i % 3 == 0 ? order(4 + t, true) : moving(4 + t),
                                  results.collect(t * each + i));
                if (i % 7 == 0) scheduler.abandon(mailbox);
            }
            scheduler.closeMailbox(mailbox);
        });
    }
    for (auto& thread : crowd) thread.join();
    painter.openGate();
    ASSERT_TRUE(results.waitFor(threads * each));
    EXPECT_EQ(results.labels().size(), std::size_t(threads * each));
    EXPECT_LE(painter.mostAtOnce(), 2);
}

}  // namespace
}  // namespace scancast
