// Pieces of a scan decoded by several threads, what comes of them handed over in the order of the pieces. Memory is bounded:
// pieces begin in order, and only while what they take together stays within a limit - or when no other is under way -, and
// who is ahead waits. One run; `take` is called on the thread that runs it. Pipeline: octree → **pieces** → point stream.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "protocol/error.hpp"
#include "threads/guarded.hpp"
#include "threads/monitor.hpp"

namespace scancast::import_octree {

/// Of all pieces that are under way, together.
inline constexpr std::uint64_t mostPieceBytes = std::uint64_t(128) << 20;
/// What a piece may have given that nobody has taken.
inline constexpr std::size_t mostWaiting = 2;

/// As many threads as there are cores, 16 at most.
inline unsigned decodingThreads() {
    return std::min(16u, std::max(1u, std::thread::hardware_concurrency()));
}

/// `Output`: points of a piece, or anything else that comes out of it.
template <class Output>
class PieceRunner {
  public:
    /// False when no more is wanted. Waits while too much of the same piece has not been taken.
    using Give = std::function<bool(Output)>;
    struct Work {
        std::size_t pieces = 0;
        /// Bytes of a piece from its beginning until all that it gave is taken.
        std::function<std::uint64_t(std::size_t piece)> memory;
        /// On any thread.
        std::function<Expected<void>(std::size_t piece, const Give&)> decode;
        /// In order; false ends the run, without an error.
        std::function<Expected<bool>(Output)> take;
    };

    /// Errors: the first in the order of the pieces, of decode() or take().
    static Expected<void> run(const Work& work, unsigned threads = decodingThreads(),
                              std::uint64_t mostBytes = mostPieceBytes) {
        PieceRunner runner(work, threads, mostBytes);
        return runner.takeAll();
    }

  private:
    /// A piece that has begun and is not all taken.
    struct UnderWay {
        std::size_t piece = 0;
        std::uint64_t bytes = 0;
        std::deque<Output> waiting;
        bool ended = false;
        std::optional<Error> error;
    };

    PieceRunner(const Work& work, unsigned threads, std::uint64_t mostBytes)
        : work_(work), mostBytes_(mostBytes), mostUnderWay_(4 * std::size_t(threads)) {
        for (unsigned i = 0; i < threads && i < work.pieces; ++i) {
            try {
                threads_.emplace_back([this] { decodeOrFail(); });
            } catch (const std::system_error&) {
                if (threads_.empty())
                    throw;  // without one of them there is nobody; with fewer it only takes longer
                break;
            }
        }
    }
    ~PieceRunner() {
        {
            const Monitor::Lock lock(monitor_);
            stopping_ = true;
        }
        for (auto& thread : threads_) thread.join();
    }
    PieceRunner(const PieceRunner&) = delete;
    PieceRunner& operator=(const PieceRunner&) = delete;

    bool allBegun() const { return stopping_ || next_ == work_.pieces; }
    bool mayBegin() const {
        if (allBegun() || underWay_.empty()) return true;
        return underWay_.size() < mostUnderWay_ && bytes_ + nextBytes_ <= mostBytes_;
    }

    /// Memory may run out between two pieces, too.
    void decodeOrFail() {
        const auto done = guarded("The decoder", [this] { decodeAll(); });
        if (done) return;
        const Monitor::Lock lock(monitor_);
        if (!failed_) failed_ = done.error();
    }

    void decodeAll() {
        for (;;) {
            UnderWay* piece = nullptr;
            {
                Monitor::Lock lock(monitor_);
                if (!bytesKnown_ && !allBegun()) learnNext();
                monitor_.wait(lock, [this] { return mayBegin(); });
                if (allBegun()) return;
                piece = underWay_.emplace_back(std::make_unique<UnderWay>()).get();
                piece->piece = next_++;
                piece->bytes = nextBytes_;
                bytes_ += nextBytes_;
                learnNext();
            }
            const auto done = guarded("The decoder", [&] {
                return work_.decode(piece->piece,
                                    [&](Output output) { return give(*piece, std::move(output)); });
            });
            const Monitor::Lock lock(monitor_);
            if (!done) piece->error = done.error();
            piece->ended = true;
        }
    }

    /// What the next piece will take; under the lock.
    void learnNext() {
        bytesKnown_ = true;
        nextBytes_ = next_ < work_.pieces ? work_.memory(next_) : 0;
    }

    bool give(UnderWay& piece, Output output) {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [&] { return stopping_ || piece.waiting.size() < mostWaiting; });
        if (stopping_) return false;
        piece.waiting.push_back(std::move(output));
        return true;
    }

    Expected<void> takeAll() {
        Monitor::Lock lock(monitor_);
        for (std::size_t piece = 0; piece < work_.pieces; ++piece) {
            monitor_.wait(lock, [this] { return failed_ || !underWay_.empty(); });
            if (failed_) return tl::unexpected(*failed_);
            UnderWay& first = *underWay_.front();
            for (;;) {
                monitor_.wait(lock, [&] { return first.ended || !first.waiting.empty(); });
                if (first.waiting.empty()) break;
                Output output = std::move(first.waiting.front());
                first.waiting.pop_front();
                lock.unlock();
                auto more = work_.take(std::move(output));
                lock.lock();
                if (!more) return passOn(std::move(more));
                if (!*more) return {};
            }
            if (first.error) return tl::unexpected(std::move(*first.error));
            bytes_ -= first.bytes;
            underWay_.pop_front();
        }
        return {};
    }

    const Work& work_;
    const std::uint64_t mostBytes_;
    const std::size_t mostUnderWay_;

    Monitor monitor_;  // guards what follows
    std::deque<std::unique_ptr<UnderWay>> underWay_;
    std::size_t next_ = 0;  ///< to begin
    std::uint64_t nextBytes_ = 0, bytes_ = 0;
    bool bytesKnown_ = false, stopping_ = false;
    std::optional<Error> failed_;  ///< a thread, not a piece

    std::vector<std::thread> threads_;
};

}  // namespace scancast::import_octree
