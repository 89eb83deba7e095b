// A picture that a device has begun: its pixels may still be on their way from the GPU while the next one is
// begun and the one before is encoded. Owned by whoever began it, used and destroyed on the device's thread,
// not later than the device. Pipeline: device → **pending frame** → frame.
#pragma once

#include <memory>
#include <utility>

#include "protocol/error.hpp"
#include "renderer/image/frame.hpp"

namespace scancast {

class PendingFrame {
  public:
    /// What is not finished is abandoned.
    virtual ~PendingFrame() = default;
    PendingFrame() = default;
    PendingFrame(const PendingFrame&) = delete;
    PendingFrame& operator=(const PendingFrame&) = delete;

    /// Whether finish() would not wait. Never waits itself.
    virtual bool ready() = 0;
    /// Waits for the pixels; once. Looks at the stop token that the picture was begun with. Errors: those of
    /// Device::draw().
    virtual Expected<Frame> finish() = 0;
};

/// A picture of a device that draws at once.
class DrawnFrame final : public PendingFrame {
  public:
    explicit DrawnFrame(Frame frame) : frame_(std::move(frame)) {}
    bool ready() override { return true; }
    Expected<Frame> finish() override { return std::move(frame_); }

  private:
    Frame frame_;
};

}  // namespace scancast
