// What a driver allows splat passes, and what it does well. Place: driver → **limits** → variants, layers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace scancast::gl {

struct GlFunctions;

struct SplatLimits {
    std::size_t storageBlockBytes = std::size_t{128} << 20;
    std::size_t texels = 65536;  ///< of a buffer
    bool keys64 = false;         ///< 64-bit atomics: GL_NV_shader_atomic_int64
    int groupSize = 128;         ///< threads of a work group, where footprints are small
    bool lookFirst = true;       ///< a look is cheaper than an atomic operation that changes nothing
    /// Turns that all loops of a thread may take together; 0: as many as they like.
    std::uint32_t loopTurns = 0;
    /// Memory that a work group's threads share in which sums are added up first (shaders/splat/sums.glsl); 0: none.
    std::uint32_t tileBytes = 0;
    bool countAdds = false;  ///< for tests: shaders/splat/sums.glsl
};

/// `software`: a rasteriser on the CPU, which draws a work group's threads one vector after the other.
/// `sumTiles`: whether sums are added up in shared memory first; nullopt = as is quicker on such a driver.
SplatLimits splatLimits(const GlFunctions& gl, bool software, std::optional<bool> sumTiles = {});

}  // namespace scancast::gl
