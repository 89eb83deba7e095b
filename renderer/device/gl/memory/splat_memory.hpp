// Where splat passes put what they find out about pixels: keys, silhouettes, sums. Owned by the device, which
// lends it to one layer after the other; inside a Current scope of its context.
#pragma once

#include <cstddef>
#include <optional>

#include "renderer/device/gl/programs/gl_handles.hpp"
#include "renderer/device/gl/programs/splat_limits.hpp"
#include "renderer/device/host/drawing.hpp"

namespace scancast::gl {

/// One or two words a pixel: what passes change by atomic operations, and later ones read as texels.
class PixelPlane {
  public:
    PixelPlane(const GlFunctions& gl, const char* what, std::size_t words)
        : gl_(gl), words_(words), buffer_(gl, what) {}

    /// Makes room. ResourceLimit.
    Expected<void> reserve(std::size_t pixels);
    /// All ones, for so many pixels.
    void clear(std::size_t pixels);
    void bindStorage(unsigned binding) const { buffer_.bindStorage(binding); }
    void bindTexels(unsigned unit) const { texels_->bind(unit); }

  private:
    const GlFunctions& gl_;
    const std::size_t words_;
    std::size_t pixels_ = 0;
    Buffer buffer_;
    std::optional<Texels> texels_;
};

/// A key per pixel: order << 32 | payload as one, or orders and payloads apart.
struct KeyPlane {
    PixelPlane keys;  ///< two words a pixel, or the one of the orders
    PixelPlane payloads;
};

class SplatMemory {
  public:
    SplatMemory(const GlFunctions& gl, const SplatLimits& limits);

    const SplatLimits& limits() const { return limits_; }
    /// Pixels that there can be at once.
    std::size_t mostPixels(const FramePasses& passes) const;
    /// Makes room. ResourceLimit.
    Expected<void> reserve(const FramePasses& passes, std::size_t pixels);
    /// Room to smooth the borders of as many pixels. ResourceLimit.
    Expected<void> reserveOwners(std::size_t pixels);

    KeyPlane nearest, cells;
    PixelPlane silhouette;  ///< orders
    Buffer sums;            ///< shaders/sums.glsl
    /// Whose paraboloid each pixel of a layer shows (shaders/owners.glsl), and its colours once borders are smoothed.
    Buffer places, halves, smoothed;

  private:
    Expected<void> reserve(KeyPlane& plane, std::size_t pixels);

    const SplatLimits limits_;
};

/// Words of a pixel's sums.
std::size_t sumWords(const FramePasses& passes);

}  // namespace scancast::gl
