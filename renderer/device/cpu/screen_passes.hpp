// The screen passes of a frame: planes of colour, depth and normal, changed in place. Called on the render
// thread; rows are shared out to the workers.
#pragma once

#include <vector>

#include "renderer/device/cpu/layer.hpp"
#include "renderer/device/cpu/pyramid.hpp"

namespace scancast::cpu {

/// What screen passes need beside the planes; lives as long as the device.
struct ScreenMemory {
    std::vector<float> around;   ///< of depths what a pass compares, with a border of background
    std::vector<float> sunSeen;  ///< by the planes' pixels, 0 - 1
    Pyramid pyramid;
};

/// What the sun sees, for ShadowPass.
struct ShadowMap {
    const Viewpoint* viewpoint = nullptr;
    const float* depth = nullptr;  ///< of its whole picture
};

/// Runs them in their order, for planes drawn with this layerView and jitter. Adds one stage each. Without
/// `sun` nothing is in the shadow.
void runScreenPasses(std::span<const Pass> passes, const LayerView& layerView, const glm::dvec2& jitter,
                     const Planes& planes, const Kernels& kernels, const Workers& workers,
                     ScreenMemory& memory, FrameStats& stats, const ShadowMap* sun = nullptr);

}  // namespace scancast::cpu
