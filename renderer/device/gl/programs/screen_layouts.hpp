// The structs that C++ and the shaders of screen passes share: one text, shaders/layouts_screen.glsl,
// compiled by both. Plain values.
#pragma once

#include <cstddef>
#include <glm/ext/vector_int4.hpp>
#include <glm/ext/vector_uint4.hpp>
#include <glm/vec4.hpp>

#include "renderer/device/host/screen_numbers.hpp"

namespace scancast::gl {

using glm::ivec4;
using glm::uvec4;
using glm::vec4;
#define SCANCAST_SCREEN_NUMBERS
#include "renderer/device/gl/shaders/screen/layouts_screen.glsl"
#undef SCANCAST_SCREEN_NUMBERS

static_assert(sizeof(PhongParams) == 64);
static_assert(offsetof(PhongParams, eye) == 16 && offsetof(PhongParams, shares) == 32 &&
              offsetof(PhongParams, sun) == 48);
static_assert(sizeof(EyeDomeLight) == 96);
static_assert(offsetof(EyeDomeLight, offsets) == 16 && offsetof(EyeDomeLight, strength) == 80);
static_assert(occlusionPairs == 24 && occlusionFull == 1.5f && occlusionFall == 0.4f);
static_assert(sizeof(OcclusionParams) == 416);
static_assert(offsetof(OcclusionParams, pairs) == 16 && offsetof(OcclusionParams, strength) == 400);
static_assert(sizeof(ShadowParams) == 96);
static_assert(offsetof(ShadowParams, map) == 16 && offsetof(ShadowParams, u) == 32);
static_assert(offsetof(ShadowParams, depth) == 64 && offsetof(ShadowParams, strength) == 80);
static_assert(sizeof(PartParams) == 48);
static_assert(offsetof(PartParams, window) == 16 && offsetof(PartParams, frames) == 32);
static_assert(sizeof(GlassParams) == 96);
static_assert(offsetof(GlassParams, depthAt) == 32 && offsetof(GlassParams, tint) == 80);
static_assert(sizeof(VisibilityParams) == 32 && offsetof(VisibilityParams, colors) == 16);
static_assert(pyramidLevels == maxPyramidLevels);
static_assert(sizeof(PyramidParams) == 592);
static_assert(offsetof(PyramidParams, layerView) == 16 && offsetof(PyramidParams, levels) == 32);
static_assert(offsetof(PyramidParams, farthest) == 416 && offsetof(PyramidParams, hide) == 512);
static_assert(offsetof(PyramidParams, normals) == 528 && offsetof(PyramidParams, closing) == 544);
static_assert(offsetof(PyramidParams, blocks) == 560 && offsetof(PyramidParams, normalLevels) == 576);

/// Storage blocks of screen passes; the shaders name the same numbers. Uniform block 0 is the pass's own.
enum ScreenBinding : unsigned {
    BindPlaneRgba = 0,
    BindPlaneDepth = 1,
    BindPlaneNormals = 2,
    BindLabels = 3,
    BindTexels = 4,
    BindPulled = 5,
    BindClosing = 6,
    // shadow.comp; light_phong.comp
    BindShadowMap = 4,
    BindSunSeen = 5,
    // glass.comp
    BindReflectedRgba = 3,
    BindReflectedDepth = 4,
    BindReflectedNormals = 5,
    // crop.comp, accumulate.comp, average.comp
    BindPart = 0,
    BindCropped = 1,
    BindRedBlue = 1,
    BindGreenAlpha = 2,
};

}  // namespace scancast::gl
