// Work groups dispatched in slices of a few milliseconds, so that a picture can be abandoned and other users
// of the GPU get their turn; as many slices are under way at a time as take little longer together than one
// may, so that the GPU does not wait for us, however short they are. Owned by a GL device; inside a Current
// scope of its context.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <stop_token>

#include "renderer/device/gl/programs/gl_handles.hpp"

namespace scancast::gl {

class Slices {
  public:
    explicit Slices(const GlFunctions& gl) : gl_(gl) {}
    ~Slices();
    Slices(const Slices&) = delete;
    Slices& operator=(const Slices&) = delete;

    /// Runs work groups [first, first + count) of the program in use, whose uniform 0 is the first of a
    /// slice. Returns when all are on their way, and all done but those of about a dozen milliseconds.
    /// Errors: Cancelled, DeviceLost.
    Expected<void> dispatch(std::uint32_t first, std::uint32_t count, const std::stop_token& stop);

  private:
    using Clock = std::chrono::steady_clock;
    struct Slice {
        GLsync fence = nullptr;
        std::uint32_t groups = 0;
    };

    /// Waits for the oldest slice and learns from how long it took.
    Expected<void> finishOldest();
    /// Whether `groups` more may be asked for before the oldest slice is done.
    bool hasRoomFor(std::uint32_t groups) const;
    std::uint32_t sliceOf(std::uint32_t left) const;

    const GlFunctions& gl_;
    std::deque<Slice> underWay_;  ///< oldest first
    std::uint32_t groupsUnderWay_ = 0;
    Clock::time_point last_ =
        {};  ///< when the oldest slice began, as far as we know: when the one before was done
    double groupMs_ = 6.0 / 64;  ///< of a work group, as learned
};

}  // namespace scancast::gl
