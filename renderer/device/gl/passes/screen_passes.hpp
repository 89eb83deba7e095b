// The screen passes of a frame: planes of colour, depth and normal, changed in place. On the render thread,
// inside a Current scope of the shaders' context.
#pragma once

#include <span>
#include <stop_token>

#include "renderer/device/gl/passes/gpu_timers.hpp"
#include "renderer/device/gl/passes/pyramid.hpp"

namespace scancast::gl {

/// What the sun sees, for ShadowPass, and room for what pixels see of the sun.
struct GpuShadowMap {
    const Viewpoint* viewpoint = nullptr;
    Buffer* depth = nullptr;  ///< of its whole picture
    Buffer* seen = nullptr;
};

/// Runs them in their order, for planes drawn with this layerView and jitter. Adds one stage each. Cancelled
/// between passes. Without `sun` nothing is in the shadow.
Expected<void> runScreenPasses(std::span<const Pass> passes, const LayerView& layerView,
                               const glm::dvec2& jitter, const GpuPlanes& planes, ScreenShaders& shaders,
                               Pyramid& pyramid, StageTimes& times, const std::stop_token& stop,
                               const GpuShadowMap* sun = nullptr);

}  // namespace scancast::gl
