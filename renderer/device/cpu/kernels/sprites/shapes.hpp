// What screen-aligned splats look like - footprints and profiles, docs/spec/sprites.md - and which of a block's reach into a tile,
// by size. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/project.hpp"

namespace scancast::cpu {
namespace {

/// Of what is drawn a vector of splats at a time: the most pixels on each side, and half the size. Just below three, so that no rounding makes a
/// seventh pixel of it.
inline constexpr int largestSide = 6;
inline constexpr float smallHalf = 2.99f;
/// Half the size above which a splat may have a third, fourth … row and column. (Above two the profile alone says what is covered, so a
/// sixth pixel is looked at a little before it can be.)
inline constexpr float pixelsFrom[largestSide] = {0, 0, 1, 1.5f, 2, 2.49f};
/// All of a vector are drawn over the square of its largest: fewer splats of more than four pixels than these are drawn apart.
inline constexpr int fewLarge = 3;
/// What is larger is drawn splat by splat, as so many rows of pixels at most. What is larger than the last is clipped
/// and drawn row by row.
inline constexpr int sizeClasses = 3;
inline constexpr int rowsOfClass[sizeClasses - 1] = {6, 8};
static_assert(rowsOfClass[sizeClasses - 2] == static_cast<int>(guardPx));

/// The splats of a block that reach into the tile, and what their fragments need beside what the block says.
struct alignas(64) Splats {
    float rise[blockSize];      ///< how fast the order grows; its unit is the profile's
    float distance[blockSize];  ///< 8 bits of distance: trunc(this · squared distance in px); pass.hpp
    std::int32_t small[blockSize];
    /// Of each vector of splats: the pixels that its largest small one covers at most, on each side; 0: there is none.
    std::int32_t sides[blockSize / wideLanes];
    std::uint16_t list[sizeClasses][blockSize];
    int count[sizeClasses];
};

template <Shape shape>
inline constexpr bool isFlat = shape == Shape::FlatSquare || shape == Shape::FlatCircle;
template <Shape shape>
inline constexpr bool isSquare =
    shape == Shape::FlatSquare || shape == Shape::ParaboloidSquare || shape == Shape::ConeSquare;
template <Shape shape>
inline constexpr bool isCone = shape == Shape::ConeSquare || shape == Shape::ConeCircle;
template <Shape shape>
inline constexpr bool isSphere = shape == Shape::SphereCircle;

/// Which of a vector of splats are drawn in the tile.
inline IntW reachesTile(const Block& b, int i, const KeyTile& tile) {
    const float left = static_cast<float>(tile.x), right = static_cast<float>(tile.x + tile.width);
    const float top = static_cast<float>(tile.y), bottom = static_cast<float>(tile.y + tile.height);
    const FloatW h = larger(load<FloatW>(b.half + i), all(0.5f));
    const FloatW x = load<FloatW>(b.x + i), y = load<FloatW>(b.y + i);
    const IntW reaches = (x + h >= left) & (x - h <= right) & (y + h >= top) & (y - h <= bottom);
    return reaches & load<IntW>(b.drawable + i);
}

inline void collectSplats(const Block& b, const KeyTile& tile, Splats& s) {
    for (int& count : s.count) count = 0;
    for (int i = 0, group = 0; i < b.padded; i += wideLanes, ++group) {
        const FloatW half = load<FloatW>(b.half + i);
        const IntW reaches = reachesTile(b, i, tile);
        const int large = __builtin_popcount(bitsOf(reaches & (half > pixelsFrom[4]) & (half <= smallHalf)));
        const bool apart = large < fewLarge;
        const FloatW most = all(apart ? pixelsFrom[4] : smallHalf);
        const IntW small = reaches & (half <= most), rest = reaches & (half > most);
        store(s.small + i, small);
        int side = apart ? 4 : largestSide;
        while (side > 2 && !anyOf<wideLanes>(small & (half > pixelsFrom[side - 1]))) --side;
        if (side == 2 && !anyOf<wideLanes>(small)) side = 0;
        s.sides[group] = side;
        if (!anyOf<wideLanes>(rest)) continue;
        for (int lane = 0; lane < wideLanes; ++lane) {
            if (rest[lane] == 0) continue;
            int sizeClass = 0;
            for (const int rows : rowsOfClass)
                sizeClass += half[lane] > 0.5f * static_cast<float>(rows) ? 1 : 0;
            s.list[sizeClass][s.count[sizeClass]++] = static_cast<std::uint16_t>(i + lane);
        }
    }
}

/// The order's growth: gain · R in units of (px/h)², px/h or 1.
template <Shape shape>
void shapeSplats(const SplatPass& pass, const Block& b, Splats& s) {
    for (int i = 0; i < b.padded; i += wideLanes) {
        const FloatW h = load<FloatW>(b.half + i);
        FloatW radius = h * pass.radiusPerPixel;
        if (pass.perspective) radius = radius * load<FloatW>(b.depth + i);
        const FloatW depthOfBorder = pass.gain * radius;
        if constexpr (isSphere<shape>) {
            store(s.rise + i, depthOfBorder);
        } else if constexpr (isCone<shape>) {
            store(s.rise + i, depthOfBorder / h);
        } else {
            store(s.rise + i, depthOfBorder / (h * h));
        }
        const FloatW atLeastAPixel = larger(h, all(0.5f));
        // Ordinals and surfaces take all 32 bits: no distance then.
        const bool colors = pass.payload == SplatPayload::Color;
        store(s.distance + i, colors ? 127.5f / (atLeastAPixel * atLeastAPixel) : all(0.0f));
    }
}

/// What a splat covers, and at which depth; in every lane another one, or the same.
template <Shape shape, int lanes>
struct SpriteProfile {
    Float<lanes> depth, half, half2, rise;

    /// `square`: of the distance to the centre, px.
    Int<lanes> covers(Float<lanes> dx, Float<lanes> dy, Float<lanes> square) const {
        if constexpr (isSquare<shape>) {
            return (dx > -half) & (dx <= half) & (dy > -half) & (dy <= half);
        } else {
            return square <= half2;
        }
    }

    Float<lanes> orderAt(Float<lanes> square) const {
        if constexpr (isSphere<shape>) {
            const Float<lanes> rest = Float<lanes>{} + 1.0f - square / half2;
            const Float<lanes> bounded = rest > 0.0f ? rest : Float<lanes>{};
            return depth + rise * (Float<lanes>{} + 1.0f - squareRoot<lanes>(bounded));
        } else if constexpr (isCone<shape>) {
            return depth + rise * squareRoot<lanes>(square);
        } else if constexpr (!isFlat<shape>) {
            return depth + rise * square;
        } else {
            return depth;
        }
    }
};

/// First row or column that a splat covers; never beyond the one that holds its centre. A square does not
/// cover what lies exactly on its lower border (pass.hpp), so that a whole even size is that many pixels.
template <Shape shape>
float firstPixel(float center, float half) {
    const float border = (center - half) - 0.5f;
    const float first = isSquare<shape> ? __builtin_floorf(border) + 1.0f : __builtin_ceilf(border);
    const float middle = __builtin_floorf(center);
    return first < middle ? first : middle;
}

/// The same of a vector of splats.
template <Shape shape>
FloatW firstPixels(FloatW center, FloatW half) {
    const FloatW border = (center - half) - 0.5f;
    const FloatW first = isSquare<shape> ? floorOf(border) + 1.0f : -floorOf(-border);
    return smaller(first, floorOf(center));
}

}  // namespace
}  // namespace scancast::cpu
