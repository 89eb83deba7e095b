// Counts finished work from any thread and passes it on a few times a second.
// Owned by the builder for one stage of its work; the sink outlives it.
#pragma once

#include <atomic>
#include <chrono>

#include "renderer/cloud/progress.hpp"

namespace scancast {

class ProgressMeter {
  public:
    ProgressMeter(const ProgressSink& sink, std::string_view stage, std::uint64_t total,
                  std::string_view unit = "points")
        : sink_(sink), stage_(stage), unit_(unit), total_(total) {}

    /// Thread-safe. Whoever finds the last report a quarter of a second old makes the next one.
    void add(std::uint64_t done) {
        const std::uint64_t sum = done_.fetch_add(done, std::memory_order_relaxed) + done;
        if (!sink_) return;
        const auto now = Clock::now().time_since_epoch().count();
        auto due = due_.load(std::memory_order_relaxed);
        const auto next = now + Clock::duration(std::chrono::milliseconds(250)).count();
        if (now >= due && due_.compare_exchange_strong(due, next)) report(sum);
    }

    /// The stage is over: says so, whatever was counted.
    void finish() {
        if (!sink_) return;
        if (total_ == 0) total_ = done_.load();
        report(total_);
    }

  private:
    using Clock = std::chrono::steady_clock;

    void report(std::uint64_t done) {
        sink_(Progress{.stage = stage_, .done = done, .total = total_, .unit = unit_});
    }

    const ProgressSink& sink_;
    std::string_view stage_, unit_;
    std::uint64_t total_;
    std::atomic<std::uint64_t> done_{0};
    std::atomic<Clock::rep> due_{0};
};

}  // namespace scancast
