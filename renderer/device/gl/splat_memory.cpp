#include "renderer/device/gl/splat_memory.hpp"

#include <algorithm>

namespace scancast::gl {
namespace {

/// Sums of more pixels than this take are drawn band by band.
constexpr std::size_t largestPlane = std::size_t{512} << 20;
/// One vector of 256 bits. More would be vectors one by one, each with a state of its own to set up.
constexpr int softwareGroup = 8;
/// Mesa's rasteriser ends a shader's loops, whatever they are doing, after 65,535 turns of all of them together (its
/// LP_MAX_TGSI_LOOP_ITERATIONS). Some of them are left for the loops that are not counted below.
constexpr std::uint32_t softwareLoopTurns = 60'000;

}  // namespace

SplatLimits splatLimits(const GlFunctions& gl, bool software) {
    SplatLimits limits;
    GLint64 block = 0;
    gl.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block);
    if (block > 0) limits.storageBlockBytes = static_cast<std::size_t>(block);
    limits.keys64 =
        hasExtension(gl, "GL_NV_shader_atomic_int64") && hasExtension(gl, "GL_ARB_gpu_shader_int64");
    if (software) {
        limits.groupSize = softwareGroup;
        limits.loopTurns = softwareLoopTurns;
    }
    return limits;
}

std::size_t sumWords(const PassPlan& plan) {
    return !plan.sum ? 0 : plan.sum->normals ? 14 : 8;
}

SplatMemory::SplatMemory(const GlFunctions& gl, const SplatLimits& limits)
    : nearest{Buffer(gl, "nearest keys"), Buffer(gl, "nearest payloads")},
      cells{Buffer(gl, "cell keys"), Buffer(gl, "cell payloads")},
      silhouette(gl, "silhouette"),
      sums(gl, "sums"),
      limits_(limits) {}

std::size_t SplatMemory::mostPixels(const PassPlan& plan) const {
    const std::size_t words = std::max<std::size_t>(limits_.keys64 ? 2 : 1, sumWords(plan));
    return std::min(limits_.storageBlockBytes, largestPlane) / (4 * words);
}

Expected<void> SplatMemory::reserve(KeyPlane& plane, std::size_t pixels) {
    if (limits_.keys64) return plane.keys.reserve(pixels * 8);
    if (auto made = plane.keys.reserve(pixels * 4); !made) return made;
    return plane.payloads.reserve(pixels * 4);
}

Expected<void> SplatMemory::reserve(const PassPlan& plan, std::size_t pixels) {
    Expected<void> made = reserve(nearest, pixels);
    if (made && plan.cell) made = reserve(cells, pixels);
    if (made && plan.silhouette) made = silhouette.reserve(pixels * 4);
    if (made && plan.sum) made = sums.reserve(pixels * sumWords(plan) * 4);
    return made;
}

}  // namespace scancast::gl
