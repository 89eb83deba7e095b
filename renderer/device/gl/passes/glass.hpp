// A mirror's glass on planes (docs/spec/mirrors.md §3): looking through it at the reflection, and in the end
// its tint. Inside a Current scope of the shaders' context.
#pragma once

#include "renderer/device/gl/passes/planes.hpp"
#include "renderer/device/gl/programs/screen_shaders.hpp"
#include "renderer/device/host/screen_numbers.hpp"

namespace scancast::gl {

/// Where the glass is seen: the reflected pixels instead of what is there, at their own depth. The
/// reflection's area lies inside the picture's.
Expected<void> lookThrough(const GlassNumbers& glass, const GpuPlanes& reflected, const GpuPlanes& picture,
                           ScreenShaders& shaders);

/// Where the glass is seen, inside `area` of the picture: its tint, and its own depth.
Expected<void> tintGlass(const GlassNumbers& glass, const glm::ivec4& area, const GpuPlanes& picture,
                         ScreenShaders& shaders);

}  // namespace scancast::gl
