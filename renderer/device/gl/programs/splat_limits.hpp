// What a driver allows splat passes, and what it does well. Place: driver → **limits** → variants, layers.
#pragma once

#include <cstddef>
#include <cstdint>

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
    /// Memory that a work group's threads share in which sums are added up first (shaders/splat/sum_tile.glsl); 0: none.
    std::uint32_t tileBytes = 0;
    bool countAdds = false;  ///< for tests: shaders/splat/sums.glsl
};

/// `software`: a rasteriser on the CPU, which draws a work group's threads one vector after the other.
SplatLimits splatLimits(const GlFunctions& gl, bool software);

}  // namespace scancast::gl
