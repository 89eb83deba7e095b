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
    /// Per block: not 0 where closing may be too narrow for some pixel, whose background is judged, too.
    const std::uint8_t* wide = nullptr;
    ClosingSize size;
    /// Per block: radius of the closing, eighths of a pixel. Becomes the mean over its visible points,
    /// or, where it has none, -1 - itself.
    std::int32_t* sizes = nullptr;
    float minGap = 0, threshold = 0;
    /// Up to this level, a pixel without a sample that has neighbours on all sides is hidden for certain:
    /// angles need no look.
    std::int32_t sureLevel = -1;
    std::uint8_t* labels = nullptr;  ///< one byte per pixel, padded: whole vectors are written
    std::int32_t labelStride = 0;
};

/// Closing of the background. Planes of bytes are padded by widestClosing and more on every side of a row.
struct Closing {
    const float* depth = nullptr;  ///< level 0 of the points, padded
    std::int32_t depthStride = 0, width = 0, height = 0;
    const float* nearest = nullptr;  ///< depths of level blockLevel: whether a block has points
    std::int32_t nearestStride = 0;
    const std::int32_t* sizes = nullptr;  ///< of HiddenPoints, settled
    const std::uint8_t* wide = nullptr;   ///< of HiddenPoints
    std::uint8_t* uncovered = nullptr;    ///< per block: some pixel of it is not covered
    std::int32_t blocksPerRow = 0, blockRows = 0;
    std::uint8_t* distance = nullptr;  ///< along columns
    std::uint8_t* covered = nullptr;   ///< 1: a point is within the radius; so is all beyond the border
    std::int32_t stride = 0;
    std::uint8_t* labels = nullptr;
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
    /// Distances along columns to samples, or to what is not covered; x0 is a multiple of 32.
    void (*closingColumns)(const Closing&, bool ofUncovered, int x0, int x1);
    /// Of a row of blocks: what is covered, and which background pixels are holes.
    void (*closingRows)(const Closing&, bool ofUncovered, int row);
    void (*pullPicture)(const FillPicture&, const FillLevel& out, int y0, int y1);
    void (*pull)(const FillLevel& fine, const FillLevel& out, int y0, int y1);
    /// Fills what `fine` does not know.
    void (*push)(const FillLevel& coarse, const FillLevel& fine, int y0, int y1);
    void (*pushPicture)(const FillLevel& coarse, const FillPicture&, int y0, int y1);
    void (*levelNormals)(const LevelNormals&, int y0, int y1);
    void (*pixelNormals)(const PixelNormals&, int y0, int y1);
};

}  // namespace scancast::cpu
