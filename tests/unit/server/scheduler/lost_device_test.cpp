// A device that is lost while it draws: another takes over, and nobody sees an error.
#include <future>

#include "tests/unit/server/scheduler/scheduler_fixture.hpp"

namespace scancast {
namespace {

using test::FakePainter;

const Error lost{ErrorCode::DeviceLost, "The GPU was reset while testing.", {}};

class DeviceIsLost : public test::SchedulerTest {
  protected:
    OpenPainter gpuThenCpu() { return gpu.open(cpu.open()); }
    static std::vector<int> widths(const FakePainter& painter) {
        std::vector<int> all;
        for (const auto& painted : painter.begun()) all.push_back(painted.view.width);
        return all;
    }

    FakePainter gpu{"gpu"}, cpu{"cpu"};
};

TEST_F(DeviceIsLost, LaterFramesComeFromTheOneThatTakesOver) {
    Scheduler scheduler(gpuThenCpu(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    for (int i = 1; i <= 6; ++i) {
        if (i == 4) gpu.failWith(lost);
        scheduler.request(mailbox, order(i), results.collect(i));
        ASSERT_TRUE(results.waitFor(std::size_t(i)));
        EXPECT_EQ(results.code(i), std::nullopt) << i;
    }
    EXPECT_EQ(widths(gpu), (std::vector<int>{1, 2, 3, 4}));
    EXPECT_EQ(widths(cpu), (std::vector<int>{4, 5, 6})) << "the picture that was lost is drawn again";
    EXPECT_EQ(results.devices(), (std::vector<std::string>{"gpu", "gpu", "gpu", "cpu", "cpu", "cpu"}));
}

TEST_F(DeviceIsLost, StatusAndMetricsSayWhatWasLostAndWhatDrawsNow) {
    Scheduler scheduler(gpuThenCpu(), {}, metrics);
    ASSERT_EQ(scheduler.waitForDevice(FakePainter::patience).info.name, "gpu");
    EXPECT_FALSE(scheduler.device().lost);
    EXPECT_EQ(metric("scancast_device_info{name=\"gpu\""),
              "scancast_device_info{name=\"gpu\",renderer=\"\"} 1");
    EXPECT_EQ(metric("scancast_devices_lost_total"), "scancast_devices_lost_total 0");
    gpu.failWith(lost);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(results.waitFor(1));
    const DeviceStatus status = scheduler.device();
    EXPECT_EQ(status.state, DeviceStatus::State::Ready);
    EXPECT_EQ(status.info.name, "cpu");
    ASSERT_TRUE(status.lost);
    EXPECT_EQ(status.lost->info.name, "gpu");
    EXPECT_EQ(status.lost->error.message, lost.message);
    EXPECT_EQ(metric("scancast_device_info{name=\"gpu\""), "");
    EXPECT_EQ(metric("scancast_device_info{name=\"cpu\""),
              "scancast_device_info{name=\"cpu\",renderer=\"\"} 1");
    EXPECT_EQ(metric("scancast_devices_lost_total"), "scancast_devices_lost_total 1");
}

TEST_F(DeviceIsLost, DuringAStillTheStillIsDrawnAgainAndCanStillBeInterrupted) {
    gpu.closeGate();
    cpu.closeGate();
    Scheduler scheduler(gpuThenCpu(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(1, true), results.collect(1));
    ASSERT_TRUE(gpu.waitBegun(1));
    gpu.failWith(lost);
    gpu.let(1);
    ASSERT_TRUE(cpu.waitBegun(1));
    scheduler.request(mailbox, order(2), results.collect(2));
    cpu.openGate();
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled) << "a newer request of its own session stopped it";
    EXPECT_EQ(results.code(2), std::nullopt);
    EXPECT_EQ(widths(cpu), (std::vector<int>{1, 2}));
}

TEST_F(DeviceIsLost, ASnapshotKeepsItsDeadline) {
    gpu.closeGate();
    cpu.closeGate();
    SchedulerOptions options;
    options.snapshotDeadline = std::chrono::milliseconds(1000);
    Scheduler scheduler(gpuThenCpu(), options, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(gpu.waitBegun(1));
    gpu.failWith(lost);
    gpu.let(1);
    ASSERT_TRUE(results.waitFor(1)) << "the gate stays closed: only the deadline can end it";
    EXPECT_EQ(results.code(1), ErrorCode::DeadlineExceeded);
}

TEST_F(DeviceIsLost, APictureThatLacksBlocksWaitsForThemOnceMore) {
    gpu.closeGate();
    cpu.unload();
    Scheduler scheduler(gpuThenCpu(), {}, metrics);
    gpu.finishLate();  // its samples are given back when it is begun, and must be found anew
    const auto mailbox = scheduler.openMailbox();
    scheduler.request(mailbox, order(1, true), results.collect(1));
    ASSERT_TRUE(gpu.waitBegun(1));
    gpu.failWith(lost);
    gpu.let(1);
    ASSERT_TRUE(cpu.waitLoading(1));
    EXPECT_TRUE(cpu.begun().empty());
    cpu.load();
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), std::nullopt);
    EXPECT_EQ(results.devices(), std::vector<std::string>{"cpu"});
}

TEST_F(DeviceIsLost, TwoPicturesOnTheirWayAreBothDrawnAgainInTheirOrder) {
    gpu.finishLate();
    gpu.closeGate();
    gpu.failWith(lost);
    std::promise<void> bothWait;
    Scheduler scheduler(
        [this, waiting = bothWait.get_future().share()] {
            waiting.wait();
            return gpuThenCpu()();
        },
        {}, metrics);
    const auto a = scheduler.openMailbox(), b = scheduler.openMailbox();
    scheduler.request(a, moving(1), results.collect(1));
    scheduler.request(b, moving(2), results.collect(2));
    bothWait.set_value();
    ASSERT_TRUE(gpu.waitBegun(2)) << "the second is begun while the first is on its way";
    gpu.openGate();
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.labels(), (std::vector<int>{1, 2}));
    EXPECT_EQ(results.devices(), (std::vector<std::string>{"cpu", "cpu"}));
    EXPECT_EQ(widths(cpu), (std::vector<int>{1, 2}));
    EXPECT_EQ(metric("scancast_devices_lost_total"), "scancast_devices_lost_total 1") << "once, not twice";
}

TEST_F(DeviceIsLost, EachThatIsLostIsFollowedByTheNext) {
    FakePainter second("second");
    gpu.failWith(lost);
    second.failWith(lost);
    Scheduler scheduler(gpu.open(second.open(cpu.open())), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.devices(), std::vector<std::string>{"cpu"});
    EXPECT_EQ(scheduler.device().lost->info.name, "second");
    EXPECT_EQ(metric("scancast_devices_lost_total"), "scancast_devices_lost_total 2");
}

TEST_F(DeviceIsLost, WithNoneToTakeOverOrdersFailWithItsReason) {
    gpu.failWith(lost);
    Scheduler scheduler(gpu.open(), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(scheduler.snapshot(order(2), results.collect(2)));
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(1), ErrorCode::DeviceLost);
    EXPECT_EQ(results.code(2), ErrorCode::DeviceLost);
    EXPECT_EQ(gpu.begun().size(), 1u) << "a lost device is not asked again";
    EXPECT_EQ(scheduler.device().state, DeviceStatus::State::Failed);
    EXPECT_EQ(scheduler.device().error.message, lost.message);
}

TEST_F(DeviceIsLost, WhenTheOtherCannotOpenBothReasonsAreTold) {
    gpu.failWith(lost);
    const OpenPainter none = []() -> Expected<Painter> {
        return fail(ErrorCode::DeviceUnavailable, "There is no memory for threads.");
    };
    Scheduler scheduler(gpu.open(none), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), ErrorCode::DeviceLost);
    const std::string message = scheduler.device().error.message;
    EXPECT_NE(message.find(lost.message), std::string::npos);
    EXPECT_NE(message.find("There is no memory for threads."), std::string::npos);
}

TEST_F(DeviceIsLost, WhileManyThreadsRequest) {
    Scheduler scheduler(gpuThenCpu(), {}, metrics);
    constexpr int threads = 4, each = 100;
    std::vector<std::thread> crowd;
    for (int t = 0; t < threads; ++t) {
        crowd.emplace_back([&, t] {
            const auto mailbox = scheduler.openMailbox();
            for (int i = 0; i < each; ++i) {
                if (t == 0 && i == each / 2) gpu.failWith(lost);
                scheduler.request(mailbox, order(4 + t, i % 3 == 0), results.collect(t * each + i));
            }
            scheduler.snapshot(order(40), [](auto) {});
        });
    }
    for (auto& thread : crowd) thread.join();
    ASSERT_TRUE(results.waitFor(threads * each));
    for (int label = 0; label < threads * each; ++label) {
        const auto code = results.code(label);
        EXPECT_TRUE(!code || code == ErrorCode::Cancelled) << "order " << label;
    }
}

}  // namespace
}  // namespace scancast
