// When a moving frame is begun: about as often as frames are wanted, and of a view that has just come. A view
// that waits gets older, and what is drawn after it answers later; so one that comes somewhat early is drawn
// at once, and one that has waited is drawn only when the next one should have come.
//
// Owned by a stream session; its thread.
#pragma once

#include <chrono>

namespace scancast {

class FramePace {
  public:
    using Time = std::chrono::steady_clock::time_point;

    /// Whether to begin a frame of the newest view, which came at `viewTime`; `fps`: wanted.
    bool allows(Time viewTime, double fps, Time now) const {
        return now >= begun_ + share(viewTime == now ? early : late, fps);
    }
    /// When a view that waits is drawn at the latest.
    Time due(double fps) const { return begun_ + share(late, fps); }
    /// A frame is begun. That one is late, because no view came in time, does not delay those after it.
    void begin(double fps, Time now) {
        const Time nominal = begun_ + share(1, fps);
        const bool onlyLate = now >= nominal && now - nominal < share(early, fps);
        begun_ = onlyLate ? nominal : now;
    }

  private:
    // Of the time of a frame. Between the two there is room for a view at 60 a second when 30 frames are
    // wanted.
    static constexpr double early = 0.6, late = 1.1;
    static std::chrono::nanoseconds share(double part, double fps) {
        return std::chrono::nanoseconds(std::int64_t(1e9 * part / fps));
    }

    Time begun_{};
};

}  // namespace scancast
