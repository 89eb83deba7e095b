// The screen passes of a plan: planes of colour, depth and normal, changed in place. On the render thread,
// inside a Current scope of the shaders' context.
#pragma once

#include <span>
#include <stop_token>

#include "renderer/device/gl/passes/gpu_timers.hpp"
#include "renderer/device/gl/passes/pyramid.hpp"

namespace scancast::gl {

/// Runs them in their order, for planes drawn with this sight and jitter. Adds one stage each. Cancelled
/// between passes.
Expected<void> runScreenPasses(std::span<const Pass> passes, const Sight& sight, const glm::dvec2& jitter,
                               const GpuPlanes& planes, ScreenShaders& shaders, Pyramid& pyramid,
                               StageTimes& times, const std::stop_token& stop);

}  // namespace scancast::gl
