// Every order is answered, whatever the scheduler's threads are doing when it comes: each pair of orders,
// with every set of threads stopped at a gate meanwhile, and let go in every order.
#include <algorithm>
#include <array>
#include <atomic>
#include <future>

#include "tests/support/gate.hpp"
#include "tests/unit/server/scheduler/scheduler_fixture.hpp"

namespace scancast {
namespace {

using test::FakePainter;
using test::Gate;
using test::soon;

constexpr int cold = 9;  // the height of pictures whose blocks are not in memory

/// Draws nothing; its gates stop the render thread, and the prepare thread where blocks are waited for.
class GatedPainter {
  public:
    Gate drawing, loading;

    OpenPainter open() {
        return [this]() -> Expected<Painter> {
            Painter painter;
            painter.prepare = [this](const PictureOrder& order, bool wait,
                                     const std::stop_token&) -> Expected<PreparedPicture> {
                if (!wait) return PreparedPicture{nullptr, order.view.height != cold};
                loading.pass();
                return PreparedPicture{};
            };
            painter.begin = [this](const PictureOrder&, const PreparedPicture&, const std::stop_token&,
                                   const Pause&) -> Expected<std::unique_ptr<PendingFrame>> {
                drawing.pass();
                Frame frame{1, 1, {0, 0, 0, 255}, {1}, {}};
                return std::make_unique<DrawnFrame>(std::move(frame));
            };
            return painter;
        };
    }
};

class SchedulerIsLive : public test::SchedulerTest {
  protected:
    static PictureOrder missing(PictureOrder order) {
        order.view.height = cold;
        return order;
    }
    GatedPainter gated;
};

// The device opens when all of them wait, so the order in which they are served is no matter of chance.
TEST_F(SchedulerIsLive, TwelveSnapshotsAtOnceOfWhatIsNotInMemoryAreAllAnswered) {
    std::promise<void> allWait;
    Scheduler scheduler(
        [&, wait = allWait.get_future().share()] {
            wait.wait();
            return gated.open()();
        },
        {}, metrics);
    for (int i = 0; i < 12; ++i) ASSERT_TRUE(scheduler.snapshot(missing(order(1)), results.collect(i)));
    allWait.set_value();
    ASSERT_TRUE(results.waitFor(12)) << results.labels().size() << " were answered";
    for (int i = 0; i < 12; ++i) EXPECT_EQ(results.code(i), std::nullopt) << i;
}

// The second waits behind the first, whose blocks come while the render thread is busy: whoever loads them
// looks for more to do, finds no room, and sleeps.
TEST_F(SchedulerIsLive, OfTwoAtOnceTheSecondIsAnsweredToo) {
    Scheduler scheduler(gated.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    for (int round = 0; round < 20; ++round) {
        gated.loading.close();
        gated.drawing.close();
        for (int i = 0; i < 2; ++i)
            ASSERT_TRUE(scheduler.snapshot(missing(order(1)), results.collect(3 * round + i)));
        ASSERT_TRUE(gated.loading.waitForSomebody());
        scheduler.request(mailbox, moving(2), results.collect(3 * round + 2));
        ASSERT_TRUE(gated.drawing.waitForSomebody());
        gated.loading.open();
        std::this_thread::yield();
        gated.drawing.open();
        ASSERT_TRUE(results.waitFor(std::size_t(3 * round + 3))) << "round " << round;
    }
}

// One of each kind of order; each is answered, one way or another, as often as it says.
class AnyOrder {
  public:
    static constexpr int kinds = 7;
    AnyOrder(Scheduler& scheduler, std::atomic<int>& answered) : scheduler_(scheduler), answered_(answered) {}

    /// Returns how many answers are due.
    int place(int kind, Scheduler::MailboxId mailbox, PictureOrder order) {
        const bool present = kind % 2 == 0;
        if (!present) order.view.height = cold;
        switch (kind) {
            case 0:
            case 1:
                EXPECT_TRUE(scheduler_.snapshot(order, done()));
                return 1;
            case 2:  // moving
                order.complete = false;
                scheduler_.request(mailbox, order, done());
                return 1;
            case 3:  // a final still
                order.interruptible = true;
                scheduler_.request(mailbox, order, done());
                return 1;
            case 4:  // a moving frame, and a newer one
                order.complete = false;
                scheduler_.request(mailbox, order, done());
                return 1 + int(scheduler_.replaceWaiting(mailbox, order, done()));
            case 5:  // a still that is not wanted any more
                order.interruptible = true;
                scheduler_.request(mailbox, order, done());
                scheduler_.abandon(mailbox);
                return 1;
            default:  // a client that leaves
                scheduler_.request(mailbox, order, done());
                scheduler_.closeMailbox(mailbox);
                return 1;
        }
    }

  private:
    PictureDone done() {
        return [this](const Expected<EncodedPicture>&) { ++answered_; };
    }

    Scheduler& scheduler_;
    std::atomic<int>& answered_;
};

TEST_F(SchedulerIsLive, ForEveryPairOfOrdersWhateverTheThreadsAreDoing) {
    Gate handingOver;  // stops the encode thread
    std::atomic<int> answered{0};
    Scheduler scheduler(gated.open(), {}, metrics);
    AnyOrder any(scheduler, answered);
    const std::array<Gate*, 3> gates{&handingOver, &gated.loading, &gated.drawing};
    const auto occupy = [&](std::size_t which) {
        gates[which]->close();
        PictureOrder one = which == 1 ? missing(order(1)) : order(1);
        EXPECT_TRUE(scheduler.snapshot(one, [&, which](const Expected<EncodedPicture>&) {
            if (which == 0) handingOver.pass();
            ++answered;
        }));
        return gates[which]->waitForSomebody();
    };
    int due = 0;
    for (int pair = 0; pair < AnyOrder::kinds * AnyOrder::kinds; ++pair) {
        if (pair / AnyOrder::kinds < pair % AnyOrder::kinds) continue;  // the other way round comes, too
        for (unsigned stopped = 0; stopped < 8; ++stopped) {
            std::vector<std::size_t> letGo;
            for (std::size_t which = 0; which < 3; ++which)
                if (stopped >> which & 1) letGo.push_back(which);
            do {
                const std::string what =
                    ::testing::PrintToString(pair) + " " + ::testing::PrintToString(letGo);
                for (std::size_t which = 0; which < 3; ++which) {
                    if (!(stopped >> which & 1)) continue;
                    ASSERT_TRUE(occupy(which)) << what;
                    ++due;
                }
                const auto a = scheduler.openMailbox(), b = scheduler.openMailbox();
                due += any.place(pair / AnyOrder::kinds, a, order(2));
                due += any.place(pair % AnyOrder::kinds, b, order(3));
                for (const std::size_t which : letGo) gates[which]->open();
                ASSERT_TRUE(soon([&] { return answered == due && scheduler.idle(); }))
                    << what << ": " << answered << " of " << due;
                scheduler.closeMailbox(a);
                scheduler.closeMailbox(b);
            } while (std::next_permutation(letGo.begin(), letGo.end()));
        }
    }
    scheduler.stop();
    scheduler.wait();
    EXPECT_EQ(answered, due) << "nothing was answered twice";
}

TEST_F(SchedulerIsLive, APreparedSnapshotThatWaitsForItsTurnHasItsDeadline) {
    SchedulerOptions options;
    options.snapshotDeadline = std::chrono::milliseconds(100);
    Scheduler scheduler(gated.open(), options, metrics);
    gated.loading.close();
    ASSERT_TRUE(scheduler.snapshot(missing(order(1)), results.collect(1)));
    ASSERT_TRUE(gated.loading.waitForSomebody());
    gated.drawing.close();
    scheduler.request(scheduler.openMailbox(), moving(2), results.collect(2));
    ASSERT_TRUE(gated.drawing.waitForSomebody());
    gated.loading.open();
    ASSERT_TRUE(results.waitFor(1)) << "the render thread is busy: only the deadline can end it";
    EXPECT_EQ(results.code(1), ErrorCode::DeadlineExceeded);
    gated.drawing.open();
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(2), std::nullopt);
}

}  // namespace
}  // namespace scancast
