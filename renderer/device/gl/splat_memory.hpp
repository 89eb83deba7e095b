// Where splat passes put what they find out about pixels: keys, silhouettes, sums. Owned by the device, which
// lends it to one layer after the other; inside a Current scope of its context.
#pragma once

#include <cstddef>

#include "renderer/device/gl/gl_handles.hpp"
#include "renderer/device/plan/pass_plan.hpp"

namespace scancast::gl {

/// What a driver allows.
struct SplatLimits {
    std::size_t storageBlockBytes = std::size_t{128} << 20;
    bool keys64 = false;  ///< 64-bit atomics: GL_NV_shader_atomic_int64
    int groupSize = 128;  ///< threads of a splat pass' work group
    /// Turns that all loops of a thread may take together; 0: as many as they like.
    std::uint32_t loopTurns = 0;
};
/// `software`: a rasteriser on the CPU, which draws a work group's threads one vector after the other.
SplatLimits splatLimits(const GlFunctions& gl, bool software);

/// A key per pixel: order << 32 | payload as one, or orders and payloads apart.
struct KeyPlane {
    Buffer keys;  ///< 64 bits a pixel, or the 32 of the orders
    Buffer payloads;
};

class SplatMemory {
  public:
    SplatMemory(const GlFunctions& gl, const SplatLimits& limits);

    const SplatLimits& limits() const { return limits_; }
    /// Pixels that there can be at once.
    std::size_t mostPixels(const PassPlan& plan) const;
    /// Makes room. ResourceLimit.
    Expected<void> reserve(const PassPlan& plan, std::size_t pixels);

    KeyPlane nearest, cells;
    Buffer silhouette;  ///< orders
    Buffer sums;        ///< shaders/sums.glsl

  private:
    Expected<void> reserve(KeyPlane& plane, std::size_t pixels);

    const SplatLimits limits_;
};

/// Words of a pixel's sums.
std::size_t sumWords(const PassPlan& plan);

}  // namespace scancast::gl
