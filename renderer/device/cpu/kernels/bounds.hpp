// What is known of a block of samples before they are placed one by one: where on the picture they lie and
// how near. Samples of a run follow a space-filling curve, so a block is small, and much of a scene can be
// left out for the price of looking at its integers: what lies in another tile, and what is hidden. Part of
// kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/vectors.hpp"

namespace scancast::cpu {
namespace {

typedef std::uint16_t Shorts8 __attribute__((vector_size(16)));

struct BlockBounds {
    bool known = false;  ///< false: reaches behind the eye or beyond what is drawn; anything is possible
    float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< of all fragments, px in the whole picture, generously
    float depth = 0;                       ///< no sample is nearer
};

inline float smallestOf(Float<4> v) {
    float m = v[0];
    for (int i = 1; i < 4; ++i) m = v[i] < m ? v[i] : m;
    return m;
}

inline float largestOf(Float<4> v) {
    return -smallestOf(-v);
}

/// Smallest and largest integers per axis.
inline void integerBounds(const SampleWords* samples, int count, Shorts8& low, Shorts8& high) {
    low = high = load<Shorts8>(samples);
    for (int i = 1; i < count; ++i) {
        const Shorts8 s = load<Shorts8>(samples + i);
        low = s < low ? s : low;
        high = s > high ? s : high;
    }
}

/// The same, from what is known of the run already.
inline void knownBounds(const BlockLimits* limits, int count, Shorts8& low, Shorts8& high) {
    low = Shorts8{} + std::uint16_t{0xffff};
    high = Shorts8{};
    for (int left = count; left > 0; left -= limitsStep, ++limits) {
        // One read holds both: low x, y, z, high x, y, z.
        const Shorts8 both = load<Shorts8>(limits);
        const Shorts8 upper = __builtin_shufflevector(both, both, 3, 4, 5, 3, 4, 5, 3, 4);
        low = both < low ? both : low;
        high = upper > high ? upper : high;
    }
}

/// The eight corners, as two vectors of four. Rounding keeps order, so no sample's depth is below the
/// corners'.
inline BlockBounds blockBounds(const SplatPass& pass, const SplatRun& run, std::uint32_t first, int count) {
    Shorts8 low, high;
    if (run.limits != nullptr) {
        knownBounds(run.limits + first / limitsStep, count, low, high);
    } else {
        integerBounds(run.samples + first, count, low, high);
    }
    const auto& m = run.toPicture;
    const float x0 = low[0], x1 = high[0], y0 = low[1], y1 = high[1], z[2] = {float(low[2]), float(high[2])};
    const Float<4> sx = {x0, x1, x0, x1}, sy = {y0, y0, y1, y1};
    BlockBounds b;
    const float margin = 0.5f * run.largestPx + 1.5f;
    for (int k = 0; k < 2; ++k) {
        const Float<4> sz = Float<4>{} + z[k];
        const Float<4> depth = m[2][0] * sx + (m[2][1] * sy + (m[2][2] * sz + m[2][3]));
        const float nearest = smallestOf(depth);
        if (!(nearest >= pass.near)) return b;
        const Float<4> inverse = pass.perspective ? 1.0f / depth : Float<4>{} + 1.0f;
        const Float<4> x =
            pass.centerX + (m[0][0] * sx + (m[0][1] * sy + (m[0][2] * sz + m[0][3]))) * inverse;
        const Float<4> y =
            pass.centerY + (m[1][0] * sx + (m[1][1] * sy + (m[1][2] * sz + m[1][3]))) * inverse;
        const float left = smallestOf(x) - margin, right = largestOf(x) + margin;
        const float top = smallestOf(y) - margin, bottom = largestOf(y) + margin;
        b.x0 = k == 0 || left < b.x0 ? left : b.x0;
        b.x1 = k == 0 || right > b.x1 ? right : b.x1;
        b.y0 = k == 0 || top < b.y0 ? top : b.y0;
        b.y1 = k == 0 || bottom > b.y1 ? bottom : b.y1;
        b.depth = k == 0 || nearest < b.depth ? nearest : b.depth;
    }
    b.known = true;
    return b;
}

/// The part of the bounds inside the tile, tile-relative; false when there is none.
inline bool clampToTile(const BlockBounds& b, const KeyTile& tile, std::int32_t (&box)[4]) {
    const float left = static_cast<float>(tile.x), right = static_cast<float>(tile.x + tile.width);
    const float top = static_cast<float>(tile.y), bottom = static_cast<float>(tile.y + tile.height);
    if (!(b.x1 >= left && b.x0 <= right && b.y1 >= top && b.y0 <= bottom)) return false;
    box[0] = static_cast<std::int32_t>(b.x0 > left ? b.x0 : left) - tile.x;
    box[1] = static_cast<std::int32_t>(b.y0 > top ? b.y0 : top) - tile.y;
    box[2] = static_cast<std::int32_t>(b.x1 < right ? b.x1 : right) - tile.x;
    box[3] = static_cast<std::int32_t>(b.y1 < bottom ? b.y1 : bottom) - tile.y;
    return true;
}

}  // namespace
}  // namespace scancast::cpu
