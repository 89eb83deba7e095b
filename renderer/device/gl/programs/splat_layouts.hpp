// The structs that splat passes and their resolving share with C++: one text, shaders/layouts_splat.glsl,
// compiled by both; and what runs are composed of. Plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/ext/vector_int4.hpp>
#include <glm/ext/vector_uint4.hpp>
#include <glm/vec4.hpp>

#include "renderer/cloud/sample.hpp"

namespace scancast::gl {

using glm::dvec4;
using glm::ivec4;
using glm::uvec4;
using glm::vec4;
#include "renderer/device/gl/shaders/splat/layouts_runs.glsl"
#include "renderer/device/gl/shaders/splat/layouts_splat.glsl"

static_assert(sizeof(Sample) == sizeof(uvec4), "a sample is one uvec4 of the shaders");
static_assert(sizeof(SplatParams) == 192);
static_assert(offsetof(SplatParams, area) == 16 && offsetof(SplatParams, size) == 32);
static_assert(offsetof(SplatParams, ramp) == 48 && offsetof(SplatParams, surfel) == 64);
static_assert(offsetof(SplatParams, extent) == 80 && offsetof(SplatParams, blur) == 96);
static_assert(offsetof(SplatParams, rotation) == 112 && offsetof(SplatParams, flags) == 160);
static_assert(offsetof(SplatParams, filters) == 176);
static_assert(sizeof(RunParams) == 128);
static_assert(offsetof(RunParams, clipMin) == 48 && offsetof(RunParams, clipMax) == 64);
static_assert(offsetof(RunParams, sizeFactors) == 80 && offsetof(RunParams, factors) == 96);
static_assert(offsetof(RunParams, color) == 112);
static_assert(sizeof(RunFacts) == 128 && offsetof(RunFacts, clipMin) == 64 && offsetof(RunFacts, color) == 112);
static_assert(sizeof(ComposeParams) == 224 && offsetof(ComposeParams, scale) == 128);
static_assert(offsetof(ComposeParams, count) == 192);
static_assert(sizeof(SplatChunk) == 32 && sizeof(SplatExtent) == 32);
static_assert(offsetof(SplatChunk, beside) == 16 && offsetof(SplatExtent, beside) == 16);
static_assert(sizeof(ResolveParams) == 144 && offsetof(ResolveParams, view) == 112);
static_assert(offsetof(ResolveParams, sprite) == 128);
static_assert(sizeof(SmoothParams) == 32 && offsetof(SmoothParams, bulge) == 16);
static_assert(offsetof(ResolveParams, planes) == 16 && offsetof(ResolveParams, ramp) == 32);
static_assert(offsetof(ResolveParams, look) == 48 && offsetof(ResolveParams, rotation) == 64);

/// Samples of a chunk at most: the work of one work group.
inline constexpr std::uint32_t samplesPerChunk = 1024;

/// Texture units, as the shaders number them.
namespace unit {
inline constexpr unsigned samples = 0;  ///< splat.comp, resolve_samples.comp: with their curvatures
inline constexpr unsigned keys = 1, payloads = 2;  ///< without 64-bit keys `keys` are orders alone
inline constexpr unsigned surfaces = 2;            ///< splat.comp: keys or payloads that hold what is visible
inline constexpr unsigned visible = 3;             ///< the nearest pass' keys or orders
inline constexpr unsigned silhouette = 4;
}  // namespace unit

/// Binding points of storage blocks by shader, as the shaders number them; OpenGL promises eight.
namespace binding {
inline constexpr unsigned runs = 1, tables = 3;  ///< splat.comp, resolve_samples.comp, compose_runs.comp
namespace composeRuns {
inline constexpr unsigned facts = 0;
}
namespace splat {
inline constexpr unsigned chunks = 2, sums = 4, keys = 4, payloads = 5;
}
namespace resolveKeys {
inline constexpr unsigned rgba = 0, depth = 1, normals = 2, background = 3;
}
namespace resolveSamples {
inline constexpr unsigned places = 0, extents = 2, halves = 4, normals = 5, rgba = 6, depth = 7;
}
namespace smooth {
inline constexpr unsigned places = 0, halves = 1, depth = 2, rgba = 3, smoothed = 4;
}
namespace resolveSums {
inline constexpr unsigned sums = 3, rgba = 6, normals = 7;
}
}  // namespace binding

}  // namespace scancast::gl
