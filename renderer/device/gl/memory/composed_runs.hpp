// A cut's runs as they are seen from somewhere: what is known of them for as long as the cut stays, composed with the
// camera in double. On the GPU where its doubles round as the processor's do, which is asked of it once; else on the
// host. Inside a Current scope of the context. Place: facts, viewpoint → **parameters of runs** → splat passes.
#pragma once

#include <span>
#include <vector>

#include "renderer/device/gl/programs/screen_shaders.hpp"
#include "renderer/device/gl/programs/splat_layouts.hpp"
#include "renderer/device/host/splats.hpp"

namespace scancast::gl {

/// That one dispatch composes: OpenGL promises 65,535 groups.
inline constexpr std::size_t mostComposedRuns = 65'535 * 64;

ComposeParams composeParams(const Viewpoint& viewpoint, std::span<const SplatPass> passes, std::size_t runs);

/// What the shader makes of them, by the host. A run of which something is too large for a float lies behind the eye.
RunParams composed(const RunFacts& facts, const ComposeParams& params);

/// The same on the GPU, from one buffer into the other; later dispatches see it. ResourceLimit, DeviceLost.
Expected<void> composeOnGpu(ScreenShaders& shaders, const Buffer& facts, const ComposeParams& params,
                            const Buffer& runs);

/// Whether the driver does what composed() does, bit by bit: of some thousand runs, near and far. One that cannot compile or run
/// it does not. DeviceLost.
Expected<bool> composesExactly(ScreenShaders& shaders);

}  // namespace scancast::gl
