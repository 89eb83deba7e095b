// Pictures within the pauses of others, on the scheduler's own threads: what the device draws is drawn, and
// what it draws around it goes on. Who may be drawn within whom is turns_test.cpp's.
#include <atomic>

#include "tests/support/gate.hpp"
#include "tests/unit/server/scheduler/scheduler_fixture.hpp"

namespace scancast {
namespace {

using test::FakePainter;
using test::soon;

/// Pictures of at least `large` px take until they are let go, and pause all the time; others take no time.
class PausingPainter {
  public:
    static constexpr int large = 1000;

    OpenPainter open(std::string name, OpenPainter instead = {}) {
        return [this, name, instead]() -> Expected<Painter> {
            Painter painter;
            painter.device.name = painter.device.identity = name;
            painter.device.pauses = true;
            painter.instead = instead;
            painter.prepare = [](const PictureOrder&, bool, const std::stop_token&) {
                return Expected<PreparedPicture>(PreparedPicture{});
            };
            painter.begin = [this](const PictureOrder& order, const PreparedPicture&,
                                   const std::stop_token& stop,
                                   const Pause& pause) { return draw(order.view.width, stop, pause); };
            return painter;
        };
    }

    std::atomic<bool> letGo{false};
    std::atomic<int> losesWidth{0}, throwsAt{0};
    std::atomic<int> drawing{0}, begun{0};

  private:
    Expected<std::unique_ptr<PendingFrame>> draw(int width, const std::stop_token& stop, const Pause& pause) {
        ++begun;
        ++drawing;
        auto frame = drawn(width, stop, pause);
        --drawing;
        return frame;
    }
    Expected<std::unique_ptr<PendingFrame>> drawn(int width, const std::stop_token& stop,
                                                  const Pause& pause) {
        if (width == throwsAt) throw std::runtime_error("The brush broke.");
        if (int loses = width; losesWidth.compare_exchange_strong(loses, 0))
            return fail(ErrorCode::DeviceLost, "The GPU was reset while testing.");
        while (width >= large && !letGo) {
            pause();
            if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "stopped");
            std::this_thread::sleep_for(std::chrono::microseconds(200));
        }
        Frame frame;
        frame.width = frame.height = 1;
        frame.rgba.own() = {0, 0, 0, 255};
        return std::make_unique<DrawnFrame>(std::move(frame));
    }
};

class Pauses : public test::SchedulerTest {
  protected:
    static constexpr int large = PausingPainter::large;
    PictureOrder costing(PictureOrder order, double price) const {
        order.price = price;
        return order;
    }
    PausingPainter pausing;
};

// What a watchdog asks for: a picture that takes long is no thread that is stuck.
TEST_F(Pauses, EndTheRenderThreadsSilence) {
    using namespace std::chrono_literals;
    Scheduler scheduler(pausing.open("cpu"), {}, metrics);
    ASSERT_TRUE(soon([&] { return scheduler.silence() == 0ms; })) << "it waits for work";
    ASSERT_TRUE(scheduler.snapshot(order(large), results.collect(0)));
    ASSERT_TRUE(soon([&] { return pausing.drawing == 1; }));
    const auto begun = std::chrono::steady_clock::now();
    // It has drawn for longer than it has been away: it came back in between.
    ASSERT_TRUE(soon([&] {
        const auto drawing = std::chrono::steady_clock::now() - begun;
        return drawing > 100ms && scheduler.silence() < drawing / 2;
    }));
    pausing.letGo = true;
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_TRUE(soon([&] { return scheduler.silence() == 0ms; }));
}

TEST_F(Pauses, FramesComeWhileASnapshotIsDrawn) {
    Scheduler scheduler(pausing.open("cpu"), {}, metrics);
    const auto mover = scheduler.openMailbox();
    ASSERT_TRUE(scheduler.snapshot(order(large), results.collect(0)));
    ASSERT_TRUE(soon([&] { return pausing.drawing == 1; }));
    for (int i = 1; i <= 50; ++i) {
        scheduler.request(mover, moving(i), results.collect(i));
        ASSERT_TRUE(results.waitFor(std::size_t(i))) << "frame " << i;
        EXPECT_EQ(results.code(i), std::nullopt);
    }
    EXPECT_EQ(pausing.drawing, 1);
    pausing.letGo = true;
    ASSERT_TRUE(results.waitFor(51));
    EXPECT_EQ(results.code(0), std::nullopt);
    EXPECT_EQ(pausing.begun, 51) << "nothing was drawn twice";
}

TEST_F(Pauses, TheTimeOfAPictureIsItsOwn) {
    const auto start = std::chrono::steady_clock::now();
    Scheduler scheduler(pausing.open("cpu"), {}, metrics);
    std::atomic<double> outer{-1}, inner{-1};
    PictureOrder costly = costing(order(large), 1e6);
    costly.client = "a";
    ASSERT_TRUE(scheduler.snapshot(
        costly, [&](const Expected<EncodedPicture>& picture) { outer = picture->renderMs; }));
    ASSERT_TRUE(soon([&] { return pausing.drawing == 1; }));
    PictureOrder cheap = costing(order(large + 1), 1);
    cheap.client = "b";
    ASSERT_TRUE(scheduler.snapshot(
        cheap, [&](const Expected<EncodedPicture>& picture) { inner = picture->renderMs; }));
    ASSERT_TRUE(soon([&] { return pausing.drawing == 2; }));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    pausing.letGo = true;
    ASSERT_TRUE(soon([&] { return outer >= 0 && inner >= 0; }));
    const double both =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    EXPECT_GE(inner, 50) << "of a hundred: its own pauses, in which nobody was let in, are not counted";
    EXPECT_LE(outer + inner, both) << "what was drawn within is not counted twice";
}

TEST_F(Pauses, WhoIsDrawnAroundMayLeave) {
    Scheduler scheduler(pausing.open("cpu"), {}, metrics);
    const auto snapshot = scheduler.snapshot(costing(order(large), 1e6), results.collect(0));
    ASSERT_TRUE(snapshot);
    ASSERT_TRUE(soon([&] { return pausing.drawing == 1; }));
    const auto mover = scheduler.openMailbox();
    scheduler.request(mover, costing(moving(large + 1), 10), results.collect(1));
    ASSERT_TRUE(soon([&] { return pausing.drawing == 2; }));
    scheduler.abandonSnapshot(*snapshot);
    scheduler.closeMailbox(mover);
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(0), ErrorCode::Cancelled);
    EXPECT_EQ(results.code(1), ErrorCode::Cancelled);
    EXPECT_TRUE(soon([&] { return scheduler.idle(); }));
}

TEST_F(Pauses, WhatThrowsWithinEndsItselfOnly) {
    Scheduler scheduler(pausing.open("cpu"), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(large), results.collect(0)));
    ASSERT_TRUE(soon([&] { return pausing.drawing == 1; }));
    pausing.throwsAt = 7;
    const auto mover = scheduler.openMailbox();
    scheduler.request(mover, moving(7), results.collect(7));
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(7), ErrorCode::Internal);
    pausing.letGo = true;
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(0), std::nullopt);
}

TEST_F(Pauses, ADeviceThatIsLostWithinIsReplacedWhenItsPictureHasEnded) {
    PausingPainter next;
    next.letGo = true;
    Scheduler scheduler(pausing.open("gpu", next.open("cpu")), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(large), results.collect(0)));
    ASSERT_TRUE(soon([&] { return pausing.drawing == 1; }));
    pausing.losesWidth = 7;
    const auto mover = scheduler.openMailbox();
    scheduler.request(mover, moving(7), results.collect(7));
    ASSERT_TRUE(soon([&] { return pausing.losesWidth == 0; }));
    EXPECT_EQ(scheduler.device().info.name, "gpu") << "a picture is still being drawn with it";
    pausing.losesWidth = large;  // as it will be, when it is used again
    pausing.letGo = true;
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(0), std::nullopt);
    EXPECT_EQ(results.code(7), std::nullopt);
    EXPECT_EQ(scheduler.device().info.name, "cpu");
    EXPECT_EQ(metric("scancast_devices_lost_total"), "scancast_devices_lost_total 1");
}

TEST_F(Pauses, TheEndComesWhilePicturesAreWithinEachOther) {
    Scheduler scheduler(pausing.open("cpu"), {}, metrics);
    double price = 1e6;
    for (int i = 0; i < 4; ++i, price /= 10) {
        PictureOrder one = costing(order(large + i), price);
        one.client = std::to_string(i);
        ASSERT_TRUE(scheduler.snapshot(one, results.collect(i)));
        ASSERT_TRUE(soon([&] { return pausing.drawing == i + 1; }));
    }
    scheduler.stop();
    scheduler.wait();
    ASSERT_TRUE(results.waitFor(4));
    for (int i = 0; i < 4; ++i) EXPECT_EQ(results.code(i), ErrorCode::Cancelled);
    EXPECT_TRUE(scheduler.idle());
}

}  // namespace
}  // namespace scancast
