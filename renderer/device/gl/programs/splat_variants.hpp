// Which variants of the splat and resolve shaders there are: what is known before a pass runs is a #define,
// the rest are parameters. Pure functions. Place: splat passes → **variants** → programs.
#pragma once

#include <string>
#include <vector>

#include "renderer/device/gl/programs/shader_source.hpp"
#include "renderer/device/gl/programs/splat_limits.hpp"
#include "renderer/device/host/drawing.hpp"
#include "renderer/device/host/splats.hpp"

namespace scancast::gl {

/// A shader and its #defines.
struct ShaderVariant {
    std::string_view shader;
    std::vector<Define> defines;
};

/// What a dispatch keeps of keys: all of them, by 64-bit atomics, or their upper and lower halves one after
/// the other.
enum class Keep : std::uint8_t { Order, Payload, Key };

/// What holds for all passes of a layer.
struct LayerTraits {
    SplatLimits limits;       ///< the driver's
    bool filters = false;     ///< some samples are not drawn: classes, clip box, regions
    bool silhouette = false;  ///< there is a silhouette to test by
};

/// splat.comp.
ShaderVariant splatVariant(const SplatPass& pass, const LayerTraits& traits, Keep keep);
/// Samples that a work group may take, 1 .. samplesPerChunk, so that no thread's loops turn more often than
/// the driver allows, on pictures of `pixels`; `regions` = those that a sample is tested against.
std::uint32_t chunkSamples(const SplatPass& pass, const LayerTraits& traits, std::size_t pixels,
                           std::size_t regions);
/// resolve_keys.comp, resolve_samples.comp, resolve_sums.comp; `normals`: into a plane of them. `owners`: into planes that
/// borders are smoothed by.
ShaderVariant resolveKeysVariant(const FramePasses& passes, bool keys64, bool normals);
ShaderVariant resolveSamplesVariant(const SplatPass& pass, bool keys64, bool normals, bool owners);
ShaderVariant resolveSumsVariant(const FramePasses& passes, bool keys64, bool normals);

}  // namespace scancast::gl
