// The border between the host and the kernels of docs/spec/pyramid.md §1: hidden point removal, pull-push,
// normals of the filled depth. Plain structs and one table of functions; the rules of kernels.hpp hold. Every
// function computes the rows [y0, y1) of what it writes, so that threads can share a picture.
//
// Planes of levels (host/screen_numbers.hpp) stand in blocks with padding around them, so that kernels may
// read beyond every side without asking: paddingX texels left and right, paddingY rows above and below.
#pragma once

#include <cstdint>

#include "renderer/device/host/screen_numbers.hpp"

namespace scancast::cpu {

inline constexpr int paddingX = 16;
inline constexpr int paddingY = 2;

/// The nearest point of each texel. +infinity = none. Level 0 has `depth` only.
struct PointLevel {
    float* depth = nullptr;
    float* x = nullptr;
    float* y = nullptr;
    float* square = nullptr;  ///< perspective: |point|²; orthographic: 1
    std::int32_t stride = 0, width = 0, height = 0;
};

struct HiddenPoints {
    PointLevel levels[maxPyramidLevels];
    Unprojection unprojection;
    /// Per block of blockSize² pixels: the coarsest level that its pixels look at.
    const std::uint8_t* reach = nullptr;
    std::int32_t blocksPerRow = 0;
    float minGap = 0, threshold = 0;
    /// Up to this level, a pixel without a sample that has neighbours on all sides is hidden for certain:
    /// angles need no look.
    std::int32_t sureLevel = -1;
    std::uint8_t* labels = nullptr;  ///< one byte per pixel, padded: whole vectors are written
    std::int32_t labelStride = 0;
};

/// Colour and depth of one level of pull-push; depth +infinity = nothing known.
struct FillLevel {
    float* depth = nullptr;
    float* red = nullptr;
    float* green = nullptr;
    float* blue = nullptr;
    std::int32_t stride = 0, width = 0, height = 0;
};

/// The picture itself, changed in place.
struct FillPicture {
    std::uint32_t* rgba = nullptr;
    float* depth = nullptr;
    std::int32_t stride = 0, width = 0, height = 0;
    const float* points = nullptr;  ///< level 0 of the points: the depths before anything is filled, padded
    std::int32_t pointStride = 0;
    const std::uint8_t* labels = nullptr;  ///< of HiddenPoints, padded
    std::int32_t labelStride = 0;
};

struct NormalLevel {
    float* x = nullptr;
    float* y = nullptr;
    float* z = nullptr;
    std::int32_t stride = 0, width = 0, height = 0;
};

/// Normals of one level from its depths.
struct LevelNormals {
    const float* depth = nullptr;
    std::int32_t depthStride = 0;
    Unprojection unprojection;
    float texel = 1;  ///< px
    NormalLevel out;
};

/// Normals of the picture's pixels between two levels.
struct PixelNormals {
    NormalLevel levels[maxPyramidLevels];
    std::int32_t count = 0;
    const float* depth = nullptr;  ///< of the picture, filled; +infinity = no normal
    std::int32_t depthStride = 0, width = 0, height = 0;
    bool perspective = true;
    float size = 0;      ///< normalScale · s0 · f: px · depth (orthographic: px)
    float smallest = 0;  ///< px: normalScale · 2τ
    std::uint32_t* out = nullptr;
    std::int32_t outStride = 0;
};

struct PyramidKernels {
    /// Level 0: the picture's depths with their padding.
    void (*copyDepth)(const float* depth, std::int32_t stride, const PointLevel& out, int y0, int y1);
    void (*firstPoints)(const PointLevel& picture, const Unprojection&, const PointLevel& out, int y0,
                        int y1);
    void (*nextPoints)(const PointLevel& fine, const PointLevel& out, int y0, int y1);
    /// y0 is a multiple of blockSize.
    void (*hidePoints)(const HiddenPoints&, int y0, int y1);
    void (*pullPicture)(const FillPicture&, const FillLevel& out, int y0, int y1);
    void (*pull)(const FillLevel& fine, const FillLevel& out, int y0, int y1);
    /// Fills what `fine` does not know.
    void (*push)(const FillLevel& coarse, const FillLevel& fine, int y0, int y1);
    void (*pushPicture)(const FillLevel& coarse, const FillPicture&, int y0, int y1);
    void (*levelNormals)(const LevelNormals&, int y0, int y1);
    void (*pixelNormals)(const PixelNormals&, int y0, int y1);
};

}  // namespace scancast::cpu
