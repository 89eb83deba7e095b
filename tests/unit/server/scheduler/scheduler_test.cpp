#include "tests/unit/server/scheduler/scheduler_fixture.hpp"

#include <algorithm>
#include <future>

namespace scancast {
namespace {

using test::FakePainter;
using test::SchedulerTest;

TEST_F(SchedulerTest, ASnapshotBecomesAJpegOfItsSize) {
    Scheduler scheduler(painter.open(), {}, metrics);
    EncodedPicture picture;
    std::promise<void> ready;
    ASSERT_TRUE(scheduler.snapshot(order(24), [&](Expected<EncodedPicture> result) {
        ASSERT_TRUE(result) << result.error().message;
        picture = std::move(*result);
        ready.set_value();
    }));
    ASSERT_EQ(ready.get_future().wait_for(FakePainter::patience), std::future_status::ready);
    EXPECT_EQ(picture.width, 24);
    // Oracle: the decoder is another library function than the encoder's caller.
    const auto decoded = decodeJpeg(*picture.bytes);
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->width, 24);
    EXPECT_EQ(decoded->height, 8);
    EXPECT_EQ(picture.stats.stages.back().name, "encode");
}

TEST_F(SchedulerTest, TheLatestRequestWinsAndOverwrittenOnesAreCounted) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(1), results.collect(1));
    ASSERT_TRUE(painter.waitBegun(1));
    for (int i = 2; i <= 10; ++i) scheduler.request(mailbox, order(i), results.collect(i));
    painter.openGate();
    ASSERT_TRUE(results.waitFor(10));
    EXPECT_EQ(begunWidths(), (std::vector<int>{1, 10}));
    EXPECT_EQ(results.code(1), std::nullopt);
    EXPECT_EQ(results.code(10), std::nullopt);
    for (int i = 2; i <= 9; ++i) EXPECT_EQ(results.code(i), ErrorCode::Cancelled);
    EXPECT_EQ(metric("scancast_frames_dropped_total{reason=\"overwritten\"}"),
              "scancast_frames_dropped_total{reason=\"overwritten\"} 8");
}

TEST_F(SchedulerTest, TellsWhatWaitsHowLongItDidAndWhatBecameOfItsPrice) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto priced = [&](int width, double ms) {
        PictureOrder one = order(width);
        one.price = ms;
        return one;
    };
    ASSERT_TRUE(scheduler.snapshot(priced(1, 1000), results.collect(1)));
    ASSERT_TRUE(painter.waitBegun(1));
    ASSERT_TRUE(scheduler.snapshot(priced(2, 2000), results.collect(2)));
    const auto left = scheduler.snapshot(priced(3, 4000), results.collect(3));
    ASSERT_TRUE(left);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(4), results.collect(4));
    EXPECT_EQ(scheduler.queues(), (QueueLengths{1, 0, 2, 0, 0}));
    scheduler.abandonSnapshot(*left);
    EXPECT_EQ(scheduler.queues(), (QueueLengths{1, 0, 1, 0, 0}));
    painter.openGate();
    ASSERT_TRUE(results.waitFor(4));
    EXPECT_EQ(metric("scancast_price_ended_seconds_total{outcome=\"drawn\"}"),
              "scancast_price_ended_seconds_total{outcome=\"drawn\"} 3");
    EXPECT_EQ(metric("scancast_price_ended_seconds_total{outcome=\"gone\"}"),
              "scancast_price_ended_seconds_total{outcome=\"gone\"} 4");
    EXPECT_EQ(metric("scancast_wait_seconds_count{kind=\"snapshot\"}"),
              "scancast_wait_seconds_count{kind=\"snapshot\"} 2");
    EXPECT_EQ(metric("scancast_wait_seconds_count{kind=\"moving\"}"),
              "scancast_wait_seconds_count{kind=\"moving\"} 1");
}

TEST_F(SchedulerTest, DeadlinesEndWaitingAndRenderingSnapshots) {
    painter.closeGate();
    SchedulerOptions options;
    options.snapshotDeadline = std::chrono::milliseconds(50);
    Scheduler scheduler(painter.open(), options, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(scheduler.snapshot(order(2), results.collect(2)));
    ASSERT_TRUE(results.waitFor(2));  // the gate stays closed: only the deadline can end them
    EXPECT_EQ(results.code(1), ErrorCode::DeadlineExceeded);
    EXPECT_EQ(results.code(2), ErrorCode::DeadlineExceeded);
    // The device is free again.
    painter.openGate();
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(3), results.collect(3));
    ASSERT_TRUE(results.waitFor(3));
    EXPECT_EQ(results.code(3), std::nullopt);
}

TEST_F(SchedulerTest, ANewViewStopsTheSessionsOwnStillAtOnce) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(1, true), results.collect(1));
    ASSERT_TRUE(painter.waitBegun(1));
    scheduler.request(mailbox, order(2), results.collect(2));
    ASSERT_TRUE(painter.waitBegun(2));  // the gate is closed, so the still can only have been stopped
    painter.openGate();
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    EXPECT_EQ(results.code(2), std::nullopt);
    EXPECT_EQ(painter.cancelled(), 1);
}

TEST_F(SchedulerTest, AStillGivesWayToTheMovingFrameOfAnother) {
    painter.closeGate();
    SchedulerOptions options;
    options.stillPatience = std::chrono::hours(1);
    Scheduler scheduler(painter.open(), options, metrics);
    const auto looker = scheduler.openMailbox(), mover = scheduler.openMailbox();
    scheduler.request(looker, order(1, true), results.collect(1));
    ASSERT_TRUE(painter.waitBegun(1));
    scheduler.request(mover, moving(2), results.collect(2));
    ASSERT_TRUE(painter.waitBegun(2)) << "the gate is closed, so the still can only have been stopped";
    EXPECT_EQ(begunWidths(), (std::vector<int>{1, 2}));
    painter.openGate();
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(begunWidths(), (std::vector<int>{1, 2, 1})) << "it is begun again, and not lost";
    EXPECT_EQ(results.code(1), std::nullopt);
    EXPECT_EQ(results.code(2), std::nullopt);
}

TEST_F(SchedulerTest, DrainingFinishesWhatWasPromisedAndTakesNothingNew) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(scheduler.snapshot(order(2), results.collect(2)));
    ASSERT_TRUE(painter.waitBegun(1));
    scheduler.drain();
    EXPECT_TRUE(scheduler.draining());
    EXPECT_FALSE(scheduler.idle());
    const auto refused = scheduler.snapshot(order(3), results.collect(3));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::ResourceLimit);
    painter.openGate();
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(1), std::nullopt);
    EXPECT_EQ(results.code(2), std::nullopt);
    scheduler.stop();
    scheduler.wait();
    EXPECT_TRUE(scheduler.idle());
}

TEST_F(SchedulerTest, AClosedMailboxStopsEverythingOfItsSession) {
    painter.closeGate();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(1), results.collect(1));
    ASSERT_TRUE(painter.waitBegun(1));
    scheduler.request(mailbox, order(2), results.collect(2));
    scheduler.closeMailbox(mailbox);
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    EXPECT_EQ(results.code(2), ErrorCode::Cancelled);
    scheduler.request(mailbox, order(3), results.collect(3));
    ASSERT_TRUE(results.waitFor(3));
    EXPECT_EQ(results.code(3), ErrorCode::Cancelled);
}

TEST_F(SchedulerTest, StopEndsEveryOrderExactlyOnce) {
    painter.closeGate();
    constexpr int sessions = 8;
    constexpr int snapshots = 20;
    {
        Scheduler scheduler(painter.open(), {}, metrics);
        for (int i = 0; i < sessions; ++i)
            scheduler.request(scheduler.openMailbox(), order(i + 1), results.collect(i));
        for (int i = 0; i < snapshots; ++i) {
            ASSERT_TRUE(scheduler.snapshot(order(50), results.collect(sessions + i)));
        }
        ASSERT_TRUE(painter.waitBegun(1));
        scheduler.stop();
        EXPECT_FALSE(scheduler.snapshot(order(9), results.collect(999)));
    }
    auto labels = results.labels();
    std::sort(labels.begin(), labels.end());
    ASSERT_EQ(labels.size(), std::size_t(sessions + snapshots));
    for (int i = 0; i < sessions + snapshots; ++i) EXPECT_EQ(labels[std::size_t(i)], i);
}

TEST_F(SchedulerTest, WithoutADeviceEveryOrderFailsWithItsReason) {
    Scheduler scheduler(
        []() -> Expected<Painter> { return fail(ErrorCode::DeviceUnavailable, "no EGL here"); }, {}, metrics);
    const auto status = scheduler.waitForDevice(FakePainter::patience);
    EXPECT_EQ(status.state, DeviceStatus::State::Failed);
    EXPECT_EQ(status.error.message, "no EGL here");
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), ErrorCode::DeviceUnavailable);
}

TEST_F(SchedulerTest, AnErrorOrExceptionOfTheRendererFailsOnePictureOnly) {
    painter.failWith(Error{ErrorCode::Unsupported, "no normals", {}});
    Scheduler scheduler(painter.open(), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), ErrorCode::Unsupported);
    painter.failWith(std::nullopt);
    PictureOrder broken = order(2);
    broken.view.width = -1;  // the fake's vector throws
    ASSERT_TRUE(scheduler.snapshot(broken, results.collect(2)));
    ASSERT_TRUE(scheduler.snapshot(order(3), results.collect(3)));
    ASSERT_TRUE(results.waitFor(3));
    EXPECT_EQ(results.code(2), ErrorCode::Internal);
    EXPECT_EQ(results.code(3), std::nullopt);
}

TEST_F(SchedulerTest, ManyThreadsAtOnce) {
    Scheduler scheduler(painter.open(), {}, metrics);
    constexpr int threads = 4;
    constexpr int each = 200;
    std::vector<std::thread> crowd;
    for (int t = 0; t < threads; ++t) {
        crowd.emplace_back([&, t] {
            const auto mailbox = scheduler.openMailbox();
            for (int i = 0; i < each; ++i) {
                scheduler.request(mailbox, order(4 + t, i % 3 == 0), results.collect(t * each + i));
                if (i % 7 == 0) scheduler.abandon(mailbox);
            }
            scheduler.closeMailbox(mailbox);
        });
    }
    for (auto& thread : crowd) thread.join();
    ASSERT_TRUE(results.waitFor(threads * each));
    auto labels = results.labels();
    std::sort(labels.begin(), labels.end());
    EXPECT_EQ(std::unique(labels.begin(), labels.end()) - labels.begin(), threads * each);
}

TEST_F(SchedulerTest, NobodyWaitsForSomebodyElsesBlocks) {
    painter.unload();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto still = scheduler.openMailbox(), mover = scheduler.openMailbox();
    scheduler.request(still, order(1, true), results.collect(1));
    ASSERT_TRUE(painter.waitLoading(1));
    for (int i = 2; i <= 6; ++i) {
        scheduler.request(mover, moving(i), results.collect(i));
        ASSERT_TRUE(results.waitFor(std::size_t(i - 1))) << "frame " << i;
    }
    EXPECT_EQ(begunWidths(), (std::vector<int>{2, 3, 4, 5, 6}));
    painter.load();
    ASSERT_TRUE(results.waitFor(6));
    EXPECT_EQ(results.code(1), std::nullopt);
}

TEST_F(SchedulerTest, ATrialIsDrawnWholeOrNotAtAll) {
    painter.unload();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, trial(1), results.collect(1));
    ASSERT_TRUE(results.waitFor(1)) << "it does not wait";
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    EXPECT_TRUE(begunWidths().empty());
    painter.load();
    scheduler.request(mailbox, trial(2), results.collect(2));
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(2), std::nullopt);
    EXPECT_EQ(begunWidths(), std::vector<int>{2});
    EXPECT_EQ(metric("scancast_frames_dropped_total{reason=\"lacking\"}"),
              "scancast_frames_dropped_total{reason=\"lacking\"} 1");
}

TEST_F(SchedulerTest, AWaitForBlocksEndsWithItsReason) {
    painter.unload();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto a = scheduler.openMailbox(), b = scheduler.openMailbox();
    scheduler.request(a, order(1, true), results.collect(1));
    ASSERT_TRUE(painter.waitLoading(1));
    scheduler.request(b, order(2, true), results.collect(2));  // behind the first
    scheduler.request(a, moving(3), results.collect(3));
    ASSERT_TRUE(results.waitFor(2)) << "a newer request ends the wait of the same session";
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    EXPECT_EQ(results.code(3), std::nullopt);
    ASSERT_TRUE(painter.waitLoading(1));
    scheduler.abandon(b);
    ASSERT_TRUE(results.waitFor(3));
    EXPECT_EQ(results.code(2), ErrorCode::Cancelled);
    scheduler.request(b, order(4, true), results.collect(4));
    ASSERT_TRUE(painter.waitLoading(1));
    scheduler.closeMailbox(b);
    ASSERT_TRUE(results.waitFor(4));
    EXPECT_EQ(results.code(4), ErrorCode::Cancelled);
}

TEST_F(SchedulerTest, SnapshotsThatWaitForBlocksHaveABoundAndADeadline) {
    painter.unload();
    SchedulerOptions options;
    options.maxSnapshots = 3;
    options.snapshotDeadline = std::chrono::milliseconds(200);
    Scheduler scheduler(painter.open(), options, metrics);
    int accepted = 0;
    for (int i = 0; i < 50; ++i) {
        if (!scheduler.snapshot(order(i + 1), results.collect(i + 1))) continue;
        ++accepted;
        if (accepted == 1) {
            ASSERT_TRUE(painter.waitLoading(1));
        }
    }
    EXPECT_GE(accepted, 3);
    EXPECT_LE(accepted, 6) << "waiting, preparing, and one on its way between the two";
    ASSERT_TRUE(results.waitFor(std::size_t(accepted)));
    EXPECT_EQ(results.code(1), ErrorCode::DeadlineExceeded);
    EXPECT_TRUE(painter.begun().empty());
}

TEST_F(SchedulerTest, TheEndComesWhileBlocksAreLoaded) {
    painter.unload();
    Scheduler scheduler(painter.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(1, true), results.collect(1));
    ASSERT_TRUE(painter.waitLoading(1));
    ASSERT_TRUE(scheduler.snapshot(order(2), results.collect(2)));
    scheduler.stop();
    scheduler.wait();
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    EXPECT_EQ(results.code(2), ErrorCode::Cancelled);
}

TEST_F(SchedulerTest, ManyThreadsWhileBlocksComeAndGo) {
    Scheduler scheduler(painter.open(), {}, metrics);
    constexpr int threads = 3, each = 150;
    std::vector<std::thread> crowd;
    for (int t = 0; t < threads; ++t) {
        crowd.emplace_back([&, t] {
            const auto mailbox = scheduler.openMailbox();
            for (int i = 0; i < each; ++i) {
                if (t == 0) i % 2 ? painter.load() : painter.unload();
                auto wanted = order(4 + t, i % 3 == 0);
                wanted.complete = i % 3 == 0;
                scheduler.request(mailbox, wanted, results.collect(t * each + i));
                if (i % 7 == 0) scheduler.abandon(mailbox);
            }
            scheduler.closeMailbox(mailbox);
        });
    }
    for (auto& thread : crowd) thread.join();
    ASSERT_TRUE(results.waitFor(threads * each));
    EXPECT_EQ(results.labels().size(), std::size_t(threads * each));
}

}  // namespace
}  // namespace scancast
