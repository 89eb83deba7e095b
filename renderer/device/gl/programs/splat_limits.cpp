#include "renderer/device/gl/programs/splat_limits.hpp"

#include <algorithm>

#include "renderer/device/gl/context/gl_context.hpp"
#include "renderer/device/gl/programs/gl_handles.hpp"

namespace scancast::gl {
namespace {

// Mesa's rasteriser, llvmpipe.
/// One vector of 256 bits. More would be vectors one by one, each with a state of its own to set up.
constexpr int softwareGroup = 8;
/// Loads and atomics of a vector's threads are done one by one: a look costs what it may spare.
constexpr bool softwareLooksFirst = false;
/// Its shared memory is the memory that sums are in, and each atomic operation costs the same on both.
constexpr bool softwareSumTiles = false;
/// A shader's loops end, whatever they are doing, after 65,535 turns of all of them together
/// (LP_MAX_TGSI_LOOP_ITERATIONS). The rest is for the loops that chunkSamples() does not count.
constexpr std::uint32_t softwareLoopTurns = 60'000;

/// Memory that a work group's threads share, of which OpenGL promises 32 KiB.
std::uint32_t sharedBytes(const GlFunctions& gl) {
    constexpr GLint promised = 32 << 10;
    GLint bytes = 0;
    gl.GetIntegerv(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, &bytes);
    return static_cast<std::uint32_t>(std::max(bytes, promised));
}

}  // namespace

SplatLimits splatLimits(const GlFunctions& gl, bool software, std::optional<bool> sumTiles) {
    SplatLimits limits;
    GLint64 block = 0;
    gl.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block);
    if (block > 0) limits.storageBlockBytes = static_cast<std::size_t>(block);
    limits.texels = mostTexels(gl);
    if (sumTiles.value_or(!software || softwareSumTiles)) limits.tileBytes = sharedBytes(gl);
    limits.keys64 =
        hasExtension(gl, "GL_NV_shader_atomic_int64") && hasExtension(gl, "GL_ARB_gpu_shader_int64");
    if (software) {
        limits.groupSize = softwareGroup;
        limits.lookFirst = softwareLooksFirst;
        limits.loopTurns = softwareLoopTurns;
    }
    return limits;
}

}  // namespace scancast::gl
