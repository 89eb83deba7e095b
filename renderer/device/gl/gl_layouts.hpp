// The structs that C++ and the shaders share: one text, shaders/layouts.glsl, compiled by both. Plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/ext/vector_int4.hpp>
#include <glm/ext/vector_uint4.hpp>
#include <glm/vec4.hpp>

#include "renderer/cloud/sample.hpp"

namespace scancast::gl {

using glm::ivec4;
using glm::uvec4;
using glm::vec4;
#include "renderer/device/gl/shaders/layouts.glsl"

static_assert(sizeof(Sample) == sizeof(uvec4), "a sample is one uvec4 of the shaders");
static_assert(sizeof(PassParams) == 64);
static_assert(offsetof(PassParams, view) == 0 && offsetof(PassParams, area) == 16);
static_assert(offsetof(PassParams, size) == 32 && offsetof(PassParams, ramp) == 48);
static_assert(sizeof(RunParams) == 112);
static_assert(offsetof(RunParams, toPicture) == 0 && offsetof(RunParams, clipMin) == 48);
static_assert(offsetof(RunParams, clipMax) == 64 && offsetof(RunParams, factors) == 80);
static_assert(offsetof(RunParams, color) == 96);
static_assert(sizeof(Chunk) == 16 && offsetof(Chunk, range) == 0);
static_assert(sizeof(EyeDomeParams) == 112);
static_assert(offsetof(EyeDomeParams, window) == 16 && offsetof(EyeDomeParams, offsets) == 32);
static_assert(offsetof(EyeDomeParams, strength) == 96);

/// Binding points; the shaders name the same numbers.
enum Binding : unsigned {
    BindParams = 0,  ///< the only uniform block; the others are storage blocks
    BindSamples = 0,
    BindRuns = 1,
    BindChunks = 2,
    BindColors = 3,
    BindOrders = 4,
    BindPayloads = 5,
    BindBackground = 6,
    BindResolved = 7,
    BindShaded = 8,
};

}  // namespace scancast::gl
