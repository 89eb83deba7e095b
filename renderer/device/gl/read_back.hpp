// Pictures on their way from the GPU: copied into mapped memory behind a fence, so that the next one can be
// begun before this one is here. Owned by a GL device; everything inside a Current scope of its context,
// except that a Pixels may be dropped without one. Pipeline: planes → **read-back** → frame.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "renderer/device/gl/gl_handles.hpp"

namespace scancast::gl {

class ReadBack {
  public:
    explicit ReadBack(const GlFunctions& gl) : gl_(gl) {}
    ~ReadBack();
    ReadBack(const ReadBack&) = delete;
    ReadBack& operator=(const ReadBack&) = delete;

    /// One picture's pixels. Not later than the ReadBack.
    class Pixels {
      public:
        ~Pixels();
        Pixels(const Pixels&) = delete;
        Pixels& operator=(const Pixels&) = delete;

        /// Whether wait() would return at once.
        bool ready();
        /// Until they are here. Errors: Cancelled, DeviceLost.
        Expected<void> wait(const std::stop_token& stop);
        /// After wait().
        std::span<const std::uint8_t> rgba() const;
        std::span<const float> depth() const;

      private:
        friend class ReadBack;
        Pixels(ReadBack& owner, std::size_t slot, std::size_t pixels)
            : owner_(owner), slot_(slot), pixels_(pixels) {}
        ReadBack& owner_;
        const std::size_t slot_, pixels_;
    };

    /// Starts with the first `pixels` words of both. ResourceLimit: no memory.
    Expected<std::unique_ptr<Pixels>> start(const Buffer& rgba, const Buffer& depth, std::size_t pixels);

  private:
    struct Slot {
        GLuint buffer = 0;
        const std::byte* mapped = nullptr;
        std::size_t bytes = 0;
        GLsync fence = nullptr;
        bool taken = false;
    };
    Expected<void> reserve(Slot& slot, std::size_t bytes);
    void release(Slot& slot);

    const GlFunctions& gl_;
    std::vector<Slot> slots_;
};

}  // namespace scancast::gl
