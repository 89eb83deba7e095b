// How busy a thread is: the share of the last seconds in which it was at work. Kept in seconds, so that it needs no memory that
// grows and answers at once.
//
// *Thread safety*: any thread; begin() and end() from the one that it is about. No clock of its own.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>

namespace scancast {

class BusyShare {
  public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;
    static constexpr std::int64_t window = 15;  ///< s, of which the last one is the one that runs

    void begin(Time now);
    void end(Time now);
    /// 0 to 1.
    double of(Time now) const;

  private:
    struct Second {
        std::int64_t number = -1;  ///< since the clock's beginning
        Clock::duration busy{};
    };
    using Seconds = std::array<Second, std::size_t(window)>;
    static void add(Seconds& seconds, Time from, Time to);

    mutable std::mutex mutex_;
    Seconds seconds_{};
    std::optional<Time> since_;  ///< it is at work, and what began then is not in seconds_ yet
};

}  // namespace scancast
