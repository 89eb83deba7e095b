// The threads that a picture is drawn with: pieces of work handed out one after another until all are done or
// the picture is no longer wanted. After every slice of some milliseconds all of them stop, others may be let in
// (pause.hpp), and they go on. Lives for one draw(), on the render thread.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stop_token>
#include <utility>

#include "renderer/device/pause.hpp"

namespace scancast::cpu {

class Workers {
  public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    /// `pause`: null or empty = never. It outlives this.
    Workers(tbb::task_arena& arena, int threads, std::stop_token stop, const Pause* pause = nullptr)
        : arena_(arena),
          threads_(threads),
          stop_(std::move(stop)),
          pause_(pause != nullptr && *pause ? pause : nullptr),
          sliceEnd_(pause_ != nullptr ? Clock::now() + slice : Time::max()) {}

    int threads() const { return threads_; }
    bool stopped() const { return stop_.stop_requested(); }
    /// What a clock would say that stands while others are let in.
    Time now() const { return Clock::now() - paused_; }
    double millisecondsSince(Time start) const {
        return std::chrono::duration<double, std::milli>(now() - start).count();
    }
    /// Whether it is time to let others in: for work whose pieces take long.
    bool sliceIsOver() const { return pause_ != nullptr && Clock::now() >= sliceEnd_; }
    /// Between pieces of what the drawing thread does by itself.
    void pauseIfDue() const {
        if (!sliceIsOver()) return;
        const auto start = Clock::now();
        (*pause_)();
        const auto end = Clock::now();
        paused_ += end - start;
        sliceEnd_ = end + slice;
    }

    /// Runs work(0) … work(count - 1), in any order; stops early when asked to.
    template <class Work>
    void inParallel(int count, const Work& work) const {
        std::atomic<int> next{0};
        // Workers take one piece after another, in order: heavy ones first, and nobody waits for a late
        // starter.
        const auto takeTurns = [&](int) {
            while (!stopped()) {
                const int i = next++;
                if (i >= count) return;
                work(i);
                if (sliceIsOver()) return;
            }
        };
        do {
            onEach(std::min(threads_, count), takeTurns);
            pauseIfDue();
        } while (next < count && !stopped());
    }

    /// Of pieces that take long: work(0) … work(count - 1), each again and again until it returns true, which means
    /// that it is done. It returns false as soon as sliceIsOver().
    template <class Work>
    void inSlices(int count, const Work& work) const {
        std::atomic<bool> left{false};
        do {
            left = false;
            onEach(count, [&](int i) {
                if (!work(i)) left = true;
            });
            pauseIfDue();
        } while (left && !stopped());
    }

    /// The same over bands of rows: work(y0, y1).
    template <class Work>
    void overRows(int rows, const Work& work) const {
        const int band = std::clamp(rows / (threads_ * 4), 8, 32);
        inParallel((rows + band - 1) / band, [&](int i) { work(i * band, std::min(rows, (i + 1) * band)); });
    }

  private:
    static constexpr std::chrono::milliseconds slice{6};  ///< and the piece that each is at when it is over

    template <class Work>
    void onEach(int workers, const Work& work) const {
        if (workers == 1) return work(0);
        arena_.execute([&] { tbb::parallel_for(0, workers, work, tbb::simple_partitioner()); });
    }

    tbb::task_arena& arena_;
    const int threads_;
    const std::stop_token stop_;
    const Pause* const pause_;
    // Changed by the drawing thread, while no worker works.
    mutable Time sliceEnd_;
    mutable Clock::duration paused_{};
};

}  // namespace scancast::cpu
