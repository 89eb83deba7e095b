// Exceptions end the picture that they are about, with its error, and nothing else: whatever throws, on
// whichever of the scheduler's threads, and whichever allocation fails.
#include <algorithm>
#include <array>
#include <atomic>

#include "server/base/memory_reserve.hpp"
#include "tests/support/failing_allocation.hpp"
#include "tests/support/gate.hpp"
#include "tests/unit/server/scheduler/scheduler_fixture.hpp"

namespace scancast {
namespace {

using test::FailingAllocation;
using test::FakePainter;
using test::soon;

/// Throws where it is told to, once.
struct ThrowingPainter {
    enum class Where { Nowhere, Open, Prepare, Wait, Begin, Ready, Finish };
    std::atomic<Where> where{Where::Nowhere};
    bool missing = false;  ///< blocks, so that they are waited for
    int side = 1;
    std::atomic<int> finished{0};

    void maybe(Where here) {
        Where wanted = here;
        if (where.compare_exchange_strong(wanted, Where::Nowhere)) throw std::bad_alloc();
    }

    struct Pending final : PendingFrame {
        Pending(ThrowingPainter& of, int side) : painter(of) {
            const auto pixels = std::size_t(side) * std::size_t(side);
            frame.width = frame.height = side;
            frame.rgba.own().resize(pixels * 4, 255);
            std::uint32_t noise = 1;  // that no encoder makes small
            for (std::uint8_t& byte : frame.rgba.own())
                byte = std::uint8_t((noise = noise * 1664525 + 1013904223) >> 24);
            frame.depth.own().resize(pixels, 1.0F);
        }
        bool ready() override {
            painter.maybe(Where::Ready);
            return true;
        }
        Expected<Frame> finish() override {
            painter.maybe(Where::Finish);
            ++painter.finished;
            return std::move(frame);
        }
        ThrowingPainter& painter;
        Frame frame;
    };

    OpenPainter open() {
        return [this]() -> Expected<Painter> {
            maybe(Where::Open);
            Painter painter;
            painter.prepare = [this](const PictureOrder& order, bool wait,
                                     const std::stop_token&) -> Expected<PreparedPicture> {
                maybe(wait ? Where::Wait : Where::Prepare);
                return PreparedPicture{nullptr, wait || !order.complete || !missing};
            };
            painter.begin = [this](const PictureOrder&, const PreparedPicture&, const std::stop_token&,
                                   const Pause&) -> Expected<std::unique_ptr<PendingFrame>> {
                maybe(Where::Begin);
                return std::make_unique<Pending>(*this, side);
            };
            return painter;
        };
    }
};

class SchedulerHasFaults : public test::SchedulerTest {
  protected:
    std::optional<ErrorCode> ask(Scheduler& scheduler, int label,
                                 PictureFormat format = PictureFormat::Jpeg) {
        PictureOrder wanted = order(1);
        wanted.format = format;
        EXPECT_TRUE(scheduler.snapshot(wanted, results.collect(label)));
        EXPECT_TRUE(results.waitFor(std::size_t(label)));
        return results.code(label);
    }
    ThrowingPainter throwing;
};

TEST_F(SchedulerHasFaults, APainterThatThrowsFailsOnePicture) {
    using Where = ThrowingPainter::Where;
    throwing.missing = true;
    Scheduler scheduler(throwing.open(), {}, metrics);
    int label = 0;
    for (const Where where : {Where::Prepare, Where::Wait, Where::Begin, Where::Finish}) {
        throwing.where = where;
        EXPECT_EQ(ask(scheduler, ++label), ErrorCode::ResourceLimit) << int(where);
        EXPECT_EQ(ask(scheduler, ++label), std::nullopt) << "after " << int(where);
    }
    throwing.where = Where::Ready;
    EXPECT_EQ(ask(scheduler, ++label), std::nullopt) << "whether it is ready can be found out otherwise";
}

TEST_F(SchedulerHasFaults, ADeviceWhoseOpeningThrowsHasFailed) {
    throwing.where = ThrowingPainter::Where::Open;
    Scheduler scheduler(throwing.open(), {}, metrics);
    const DeviceStatus status = scheduler.waitForDevice(FakePainter::patience);
    EXPECT_EQ(status.state, DeviceStatus::State::Failed);
    EXPECT_NE(status.error.message.find("did not get the memory"), std::string::npos) << status.error.message;
    EXPECT_EQ(ask(scheduler, 1), ErrorCode::ResourceLimit);
}

TEST_F(SchedulerHasFaults, AnEncoderWithoutMemoryFailsOnePicture) {
    throwing.side = 512;
    test::Gate gate;
    Scheduler scheduler(throwing.open(), {}, metrics);
    int label = 0;
    for (const PictureFormat format : {PictureFormat::Depth, PictureFormat::Png}) {
        gate.close();  // holds the encode thread until the frame that is to fail has been drawn
        ASSERT_TRUE(scheduler.snapshot(order(1), [&](const Expected<EncodedPicture>&) { gate.pass(); }));
        ASSERT_TRUE(gate.waitForSomebody());
        PictureOrder wanted = order(1);
        wanted.format = format;
        ASSERT_TRUE(scheduler.snapshot(wanted, results.collect(++label)));
        ASSERT_TRUE(soon([&] { return throwing.finished == 3 * (label / 2) + 2; }));
        {
            const FailingAllocation fails(1, 512 * 512);
            gate.open();
            ASSERT_TRUE(results.waitFor(std::size_t(label)));
            EXPECT_TRUE(fails.happened());
        }
        EXPECT_EQ(results.code(label), ErrorCode::ResourceLimit);
        EXPECT_EQ(ask(scheduler, ++label, format), std::nullopt);
    }
}

TEST_F(SchedulerHasFaults, ACallbackThatThrowsIsItsOwnAffair) {
    Scheduler scheduler(throwing.open(), {}, metrics);
    const auto mailbox = scheduler.openMailbox();
    std::atomic<int> calls{0};
    const PictureDone throws = [&](const Expected<EncodedPicture>&) {
        ++calls;
        throw std::runtime_error("the client's connection is odd");
    };
    ASSERT_TRUE(scheduler.snapshot(order(1), throws));
    EXPECT_EQ(ask(scheduler, 1), std::nullopt);
    scheduler.request(mailbox, order(2), throws);
    EXPECT_EQ(ask(scheduler, 2), std::nullopt);
    scheduler.stop();
    scheduler.wait();
    EXPECT_EQ(calls, 2) << "each once";
    EXPECT_TRUE(scheduler.idle());
}

// Of all the allocations that a few orders cause, each in turn fails: every order is answered once, and the
// next picture comes.
TEST_F(SchedulerHasFaults, EveryAllocationMayFail) {
    throwing.missing = true;
    Scheduler scheduler(throwing.open(), {}, metrics);
    ASSERT_EQ(ask(scheduler, 1), std::nullopt);
    bool happened = true;
    std::uint64_t nth = 0;
    while (happened) {
        std::array<std::atomic<int>, 4> answers{};
        const auto count = [&](std::size_t i) {
            return [&, i](const Expected<EncodedPicture>&) { ++answers[i]; };
        };
        const auto looker = scheduler.openMailbox(), mover = scheduler.openMailbox();
        {
            const FailingAllocation fails(++nth);
            scheduler.request(looker, order(2, true), count(0));
            ASSERT_TRUE(scheduler.snapshot(order(3), count(1)));
            ASSERT_TRUE(scheduler.snapshot(order(4), count(2)));
            scheduler.request(mover, moving(5), count(3));
            ASSERT_TRUE(soon([&] {
                return scheduler.idle() &&
                       std::all_of(answers.begin(), answers.end(), [](const auto& n) { return n > 0; });
            })) << "when allocation "
                << nth << " failed";
            happened = fails.happened();
        }
        for (const auto& n : answers) ASSERT_EQ(n, 1) << nth;
        scheduler.closeMailbox(looker);
        scheduler.closeMailbox(mover);
    }
    EXPECT_GT(nth, 50U);
    EXPECT_EQ(ask(scheduler, 2), std::nullopt);
}

TEST_F(SchedulerHasFaults, APictureThatThereIsNoMemoryForIsRefusedBeforeItIsBegun) {
    SchedulerOptions options;
    options.room = [] {
        return MemoryRoom{100 << 20, "the limit of its address space (RLIMIT_AS), 3072 MiB"};
    };
    Scheduler scheduler(painter.open(), options, metrics);
    PictureOrder large = order(8000);
    large.view.height = 8000;
    std::string why;
    ASSERT_TRUE(scheduler.snapshot(large, [&](const Expected<EncodedPicture>& picture) {
        if (!picture) why = picture.error().message;
        results.collect(1)(picture);
    }));
    ASSERT_TRUE(results.waitFor(1));
    EXPECT_EQ(results.code(1), ErrorCode::ResourceLimit);
    EXPECT_NE(why.find("8000 x 8000"), std::string::npos) << why;
    EXPECT_NE(why.find("RLIMIT_AS"), std::string::npos) << why;
    EXPECT_TRUE(painter.begun().empty());
    ASSERT_TRUE(scheduler.snapshot(order(2), results.collect(2)));
    ASSERT_TRUE(results.waitFor(2));
    EXPECT_EQ(results.code(2), std::nullopt);
}

TEST(Faults, AreLoggedOnceAndThenByTens) {
    std::vector<std::string> lines;
    FaultLog log([&](const std::string& line) { lines.push_back(line); });
    for (int i = 0; i < 250; ++i) log.report({ErrorCode::Internal, "The lens fell off.", {}});
    log.report({ErrorCode::Internal, "The tripod, too.", {}});
    EXPECT_EQ(lines, (std::vector<std::string>{"The lens fell off.", "The lens fell off. (10 times by now)",
                                               "The lens fell off. (100 times by now)", "The tripod, too."}));
    for (int i = 0; i < 1000; ++i) log.report({ErrorCode::Internal, "Fault " + std::to_string(i), {}});
    EXPECT_LT(lines.size(), 80U) << "sentences that always differ do not fill the log either";
}

TEST(Faults, SayWhatWasThrown) {
    const auto of = [](auto thrown) { return guarded("The lens", [&] { throw thrown; }).error(); };
    EXPECT_EQ(of(std::bad_alloc()).code, ErrorCode::ResourceLimit);
    EXPECT_EQ(of(std::runtime_error("cracked")).code, ErrorCode::Internal);
    EXPECT_EQ(of(std::runtime_error("cracked")).message, "The lens failed: cracked");
    EXPECT_EQ(of(42).code, ErrorCode::Internal);
    EXPECT_EQ(guarded("The lens", [] { return 42; }), 42);
    EXPECT_EQ(
        guarded("The lens", []() -> Expected<int> { return fail(ErrorCode::Io, "dusty"); }).error().code,
        ErrorCode::Io);
}

TEST(MemoryReserve, HelpsOnceUntilTheFailureIsDealtWith) {
    keepMemoryReserve();
    const auto canAllocate = [] {
        bool could = false;
        const FailingAllocation fails(1);  // of other threads than this one
        std::thread other([&] { could = guarded("", [] { return std::make_unique<int>(7); }).has_value(); });
        other.join();
        return could;
    };
    EXPECT_TRUE(canAllocate());
    EXPECT_FALSE(canAllocate());
    refillMemoryReserve();
    EXPECT_TRUE(canAllocate());
    std::set_new_handler(nullptr);
}

TEST(MemoryRoom, IsWhatTheTightestLimitLeaves) {
    EXPECT_EQ(roomOf({}).bytes, ~std::uint64_t(0));
    MemoryFacts facts;
    facts.available = 5000;
    EXPECT_EQ(roomOf(facts).bytes, 5000U);
    facts.addressLimit = 4000;
    facts.addressUsed = 1500;
    EXPECT_EQ(roomOf(facts).bytes, 2500U);
    EXPECT_NE(roomOf(facts).limit.find("RLIMIT_AS"), std::string::npos);
    facts.groupLimit = 1000;
    facts.groupUsed = 1200;
    EXPECT_EQ(roomOf(facts).bytes, 0U);
    const MemoryRoom here = memoryRoom();
    EXPECT_GT(here.bytes, 0U);
    EXPECT_LT(here.bytes, std::uint64_t(1) << 60) << "the system says something";
}

}  // namespace
}  // namespace scancast
