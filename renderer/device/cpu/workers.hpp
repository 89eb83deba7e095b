// The threads that a picture is drawn with: pieces of work handed out one after another until all are done or
// the picture is no longer wanted. Lives for one draw(), on the render thread.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <stop_token>
#include <utility>

namespace scancast::cpu {

class Workers {
  public:
    Workers(tbb::task_arena& arena, int threads, std::stop_token stop)
        : arena_(arena), threads_(threads), stop_(std::move(stop)) {}

    int threads() const { return threads_; }
    bool stopped() const { return stop_.stop_requested(); }
    /// Of the calling thread, 0 … threads() - 1 inside work.
    static std::size_t index() {
        return static_cast<std::size_t>(std::max(0, tbb::this_task_arena::current_thread_index()));
    }

    /// Runs work(0) … work(count - 1), in any order; stops early when asked to.
    template <class Work>
    void inParallel(int count, const Work& work) const {
        std::atomic<int> next{0};
        const int workers = std::min(threads_, count);
        // Workers take one piece after another, in order: heavy ones first, and nobody waits for a late
        // starter.
        const auto takeTurns = [&](int) {
            for (int i = next++; i < count && !stopped(); i = next++) work(i);
        };
        if (workers <= 1) return takeTurns(0);
        arena_.execute([&] { tbb::parallel_for(0, workers, takeTurns, tbb::simple_partitioner()); });
    }

    /// The same over bands of rows: work(y0, y1).
    template <class Work>
    void overRows(int rows, const Work& work) const {
        const int band = std::max(8, rows / (threads_ * 4));
        inParallel((rows + band - 1) / band, [&](int i) { work(i * band, std::min(rows, (i + 1) * band)); });
    }

  private:
    tbb::task_arena& arena_;
    const int threads_;
    const std::stop_token stop_;
};

}  // namespace scancast::cpu
