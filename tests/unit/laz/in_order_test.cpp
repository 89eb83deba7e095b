// Jobs beside each other, results in order.
#include "importers/in_order.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

namespace scancast {

namespace {

Piece pieceOf(std::size_t number) {
    return Piece(1, static_cast<std::byte>(number));
}

/// Gives `pieces` pieces for each job, the early jobs late.
std::function<JobWorker()> slowFirst(std::size_t pieces) {
    return [pieces]() -> JobWorker {
        return [pieces](std::size_t job, const GivePiece& give) -> Expected<void> {
            for (std::size_t i = 0; i < pieces; ++i) {
                if (job % 3 == 0) std::this_thread::sleep_for(std::chrono::microseconds(300));
                if (!give(pieceOf(job * pieces + i))) break;
            }
            return {};
        };
    };
}

}  // namespace

TEST(InOrder, GivesWhatOneThreadWouldGive) {
    for (const std::size_t threads : {1, 2, 5}) {
        std::size_t next = 6;
        const auto done = runInOrder(2, 40, {.threads = threads}, slowFirst(3),
                                     [&](std::size_t job, const Piece& piece) -> Expected<bool> {
                                         EXPECT_EQ(job, next / 3);
                                         EXPECT_EQ(piece, pieceOf(next));
                                         ++next;
                                         return true;
                                     });
        ASSERT_TRUE(done);
        EXPECT_EQ(next, 120U);
    }
    EXPECT_TRUE(runInOrder(5, 5, {.threads = 2}, slowFirst(1),
                           [](std::size_t, const Piece&) -> Expected<bool> { return true; }));
}

TEST(InOrder, EndsWhenItIsEnough) {
    std::size_t taken = 0;
    const auto done = runInOrder(0, 1'000'000, {.threads = 3}, slowFirst(2),
                                 [&](std::size_t, const Piece&) -> Expected<bool> { return ++taken < 7; });
    EXPECT_TRUE(done);
    EXPECT_EQ(taken, 7U);
}

/// Nobody is far ahead of what is taken.
TEST(InOrder, IsBounded) {
    std::atomic<std::size_t> given = 0;
    std::size_t taken = 0;
    const auto worker = [&]() -> JobWorker {
        return [&](std::size_t job, const GivePiece& give) -> Expected<void> {
            for (std::size_t i = 0; i < 20 && give(pieceOf(job)); ++i) ++given;
            return {};
        };
    };
    const auto done = runInOrder(
        0, 30, {.threads = 3, .waiting = 2}, worker, [&](std::size_t, const Piece&) -> Expected<bool> {
            std::this_thread::sleep_for(std::chrono::microseconds(100));
            ++taken;
            EXPECT_LE(given,
                      taken + 6 * 3);  // two jobs for each thread with two pieces each, and one in each hand
            return true;
        });
    EXPECT_TRUE(done);
    EXPECT_EQ(taken, 600U);
}

TEST(InOrder, TellsTheFirstFailureInOrder) {
    std::size_t taken = 0;
    const auto worker = []() -> JobWorker {
        return [](std::size_t job, const GivePiece& give) -> Expected<void> {
            if (job == 9) throw std::runtime_error("nine");
            if (job == 4) std::this_thread::sleep_for(std::chrono::milliseconds(20));
            if (job == 4 || job == 6) return fail(ErrorCode::Malformed, "job " + std::to_string(job));
            give(pieceOf(job));
            return {};
        };
    };
    const auto take = [&](std::size_t, const Piece&) -> Expected<bool> {
        ++taken;
        return true;
    };
    const auto done = runInOrder(0, 20, {.threads = 4}, worker, take);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().message, "job 4");
    EXPECT_EQ(taken, 4U);
    EXPECT_FALSE(runInOrder(7, 20, {.threads = 2}, worker, take));  // what is thrown is an error, too
    const auto refusing = [](std::size_t, const Piece&) -> Expected<bool> {
        return fail(ErrorCode::Io, "gone");
    };
    EXPECT_EQ(runInOrder(0, 3, {.threads = 2}, worker, refusing).error().message, "gone");
}

}  // namespace scancast
