// Pieces that several threads decode come out in order, within their memory, and end at the first error.
#include <gtest/gtest.h>

#include <atomic>
#include <numeric>

#include "importers/octree/tree/piece_runner.hpp"

namespace scancast::test {

namespace {

using Runner = import_octree::PieceRunner<int>;

/// Piece n gives n % 7 numbers: 10 n, 10 n + 1 …
Runner::Work workOf(std::size_t pieces, std::vector<int>& taken) {
    Runner::Work work;
    work.pieces = pieces;
    work.memory = [](std::size_t) { return 10; };
    work.decode = [](std::size_t piece, const Runner::Give& give) -> Expected<void> {
        for (int i = 0; i < static_cast<int>(piece % 7); ++i)
            if (!give(static_cast<int>(10 * piece) + i)) return {};
        return {};
    };
    work.take = [&taken](int number) -> Expected<bool> {
        taken.push_back(number);
        return true;
    };
    return work;
}

}  // namespace

TEST(PieceRunner, GivesAllInOrder) {
    std::vector<int> expected;
    for (int piece = 0; piece < 300; ++piece)
        for (int i = 0; i < piece % 7; ++i) expected.push_back(10 * piece + i);
    for (const unsigned threads : {1U, 2U, 5U})
        for (const std::uint64_t bytes : {0U, 10U, 25U, 1000U}) {
            std::vector<int> taken;
            ASSERT_TRUE(Runner::run(workOf(300, taken), threads, bytes));
            ASSERT_EQ(taken, expected);
        }
    std::vector<int> none;
    EXPECT_TRUE(Runner::run(workOf(0, none), 3));
}

TEST(PieceRunner, StaysWithinItsMemory) {
    std::vector<int> taken;
    auto work = workOf(200, taken);
    std::atomic<int> underWay{0}, most{0};
    const auto decode = work.decode;
    work.decode = [&](std::size_t piece, const Runner::Give& give) {
        const int now = ++underWay;
        int seen = most;
        while (now > seen && !most.compare_exchange_weak(seen, now)) continue;
        auto done = decode(piece, give);
        --underWay;
        return done;
    };
    ASSERT_TRUE(Runner::run(work, 8, 30));
    EXPECT_LE(most, 3);
    EXPECT_EQ(taken.size(), 28U * 21 + 6);
}

TEST(PieceRunner, EndsAtTheFirstErrorOfItsPieces) {
    for (const bool thrown : {false, true}) {
        std::vector<int> taken;
        auto work = workOf(100, taken);
        work.decode = [&](std::size_t piece, const Runner::Give& give) -> Expected<void> {
            if (piece == 40 && thrown) throw std::bad_alloc();
            if (piece >= 40) return fail(ErrorCode::Malformed, "piece " + std::to_string(piece));
            give(static_cast<int>(piece));
            return {};
        };
        const auto done = Runner::run(work, 4);
        ASSERT_FALSE(done);
        EXPECT_EQ(done.error().code, thrown ? ErrorCode::ResourceLimit : ErrorCode::Malformed);
        EXPECT_EQ(taken.size(), 40U);
    }
}

TEST(PieceRunner, EndsWhenNobodyWantsMore) {
    std::vector<int> taken;
    auto work = workOf(1000, taken);
    work.take = [&](int number) -> Expected<bool> {
        taken.push_back(number);
        return taken.size() < 5;
    };
    EXPECT_TRUE(Runner::run(work, 4));
    EXPECT_EQ(taken.size(), 5U);
    work.take = [](int) -> Expected<bool> { return fail(ErrorCode::Io, "gone"); };
    EXPECT_EQ(Runner::run(work, 4).error().message, "gone");
}

}  // namespace scancast::test
