// From planes to what leaves the GPU: the window's part of a plane, and the mean of a picture's jittered
// frames. Owned by a GL device; everything, destruction included, inside a Current scope of its context.
// Pipeline: screen passes → **average** → read-back.
#pragma once

#include "renderer/device/gl/passes/planes.hpp"
#include "renderer/device/gl/programs/screen_shaders.hpp"

namespace scancast::gl {

/// Writes the part `window` (x, y, width, height, inside the area) of a plane of `area`, row by row.
Expected<void> crop(const Buffer& plane, const glm::ivec4& area, const glm::ivec4& window, Buffer& out,
                    ScreenShaders& shaders);

/// The integer mean of frames: colour weighted by coverage, straight alpha.
class FrameAverage {
  public:
    /// Sums have 16 bits a channel.
    static constexpr int mostFrames = 257;

    /// `shaders` outlive it.
    explicit FrameAverage(ScreenShaders& shaders);

    /// Forgets what was added; for pictures of this size.
    Expected<void> begin(int width, int height);
    /// Adds one frame's window, of the size that begin() was told. At most mostFrames.
    Expected<void> add(const GpuPlanes& planes, const glm::ivec4& window);
    /// The mean of what was added, row by row. At least one frame.
    Expected<void> write(Buffer& rgba);

  private:
    ScreenShaders& shaders_;
    Buffer redBlue_, greenAlpha_;
    int width_ = 0, height_ = 0;
    std::uint32_t frames_ = 0;
};

}  // namespace scancast::gl
