// What a picture was prepared for is gone when it is drawn - ranks that were lost, which would have had its samples -: it is prepared
// again, and nobody sees an error.
#include <atomic>

#include "tests/unit/server/scheduler/scheduler_fixture.hpp"

namespace scancast {
namespace {

using test::FakePainter;

class SamplesAreGone : public test::SchedulerTest {
  protected:
    /// The next `times` pictures that are begun, or finished, are refused; from the first one on blocks may be missing.
    OpenPainter refusing(int times, bool inTheEnd = false) {
        left = times;
        return [this, inTheEnd, open = fake.open()]() -> Expected<Painter> {
            auto painter = open();
            if (!painter) return painter;
            painter->prepare = [this, prepare = painter->prepare](const PictureOrder& one, bool wait,
                                                                  std::stop_token stop) {
                ++(wait ? waited : prepared);
                return prepare(one, wait, std::move(stop));
            };
            painter->begin = [this, inTheEnd, begin = painter->begin](
                                 const PictureOrder& one, const PreparedPicture& with, std::stop_token stop,
                                 const Pause& pause) -> Expected<std::unique_ptr<PendingFrame>> {
                if (!inTheEnd && refuses()) return tl::unexpected(gone);
                auto begun = begin(one, with, std::move(stop), pause);
                if (begun && inTheEnd && refuses()) return std::make_unique<Refused>();
                return begun;
            };
            return painter;
        };
    }

    FakePainter fake;
    std::atomic<int> left = 0, prepared = 0, waited = 0;
    bool unloads = false;  ///< with the first refusal

  private:
    static inline const Error gone{ErrorCode::Unavailable, "The ranks are not there.", {}};
    struct Refused final : PendingFrame {
        bool ready() override { return true; }
        Expected<Frame> finish() override { return tl::unexpected(gone); }
    };
    bool refuses() {
        if (left <= 0) return false;
        --left;
        if (unloads) fake.unload();
        return true;
    }
};

TEST_F(SamplesAreGone, WhatWasPreparedForThemIsPreparedAgain) {
    for (const bool inTheEnd : {false, true}) {
        prepared = 0;
        Scheduler scheduler(refusing(2, inTheEnd), {}, metrics);
        const auto mailbox = scheduler.openMailbox();
        const int label = inTheEnd ? 2 : 1;
        scheduler.request(mailbox, order(1), results.collect(label));
        ASSERT_TRUE(results.waitFor(std::size_t(label)));
        EXPECT_EQ(results.code(label), std::nullopt);
        EXPECT_EQ(prepared, 3) << inTheEnd;
    }
}

TEST_F(SamplesAreGone, WhatMustBeCompleteWaitsThenForWhatIsMissing) {
    unloads = true;
    Scheduler scheduler(refusing(1), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(fake.waitLoading(1)) << "before, everything was there";
    fake.load();
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), std::nullopt);
    EXPECT_EQ(waited, 1);
}

TEST_F(SamplesAreGone, WhatIsRefusedAgainAndAgainEnds) {
    Scheduler scheduler(refusing(1000), {}, metrics);
    ASSERT_TRUE(scheduler.snapshot(order(1), results.collect(1)));
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), ErrorCode::Unavailable);
    EXPECT_GT(left, 900);
    left = 0;
    ASSERT_TRUE(scheduler.snapshot(order(2), results.collect(2)));
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(2), std::nullopt);
}

}  // namespace
}  // namespace scancast
