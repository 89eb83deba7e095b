// Work groups dispatched in slices of a few milliseconds, so that a picture can be abandoned and other users
// of the GPU get their turn; two slices are under way at a time, so that the GPU does not wait for us. Owned
// by a GL device; inside a Current scope of its context.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <stop_token>

#include "renderer/device/gl/gl_handles.hpp"

namespace scancast::gl {

class Slices {
  public:
    explicit Slices(const GlFunctions& gl) : gl_(gl) {}
    ~Slices();
    Slices(const Slices&) = delete;
    Slices& operator=(const Slices&) = delete;

    /// Runs work groups [first, first + count) of the program in use, whose uniform 0 is the first of a
    /// slice. Returns when all are on their way, and all but the last two slices done. Errors: Cancelled,
    /// DeviceLost.
    Expected<void> dispatch(std::uint32_t first, std::uint32_t count, const std::stop_token& stop);

  private:
    using Clock = std::chrono::steady_clock;
    struct Fence {
        GLsync sync = nullptr;
        std::uint32_t groups = 0;
    };

    /// Waits for the older slice and learns from how long it took.
    Expected<void> finishOldest();
    void learn(std::uint32_t groups, double milliseconds);

    const GlFunctions& gl_;
    std::array<Fence, 2> underWay_{};  ///< older first
    Clock::time_point last_ = {};  ///< when a slice began, as far as we know: when the one before it was done
    std::uint32_t slice_ = 64;     ///< work groups, adapted
};

}  // namespace scancast::gl
