// Sprites of up to six by six pixels, which most are: a vector of splats at a time, all of them over a square of as many
// pixels as the largest needs. So everything but the comparison with what is there already is computed for a whole
// vector. Nothing is clipped: what hangs over the tile's border falls into its guard band. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/sprites/shapes.hpp"

namespace scancast::cpu {
namespace {

/// Of so many pixels in a row, each splat's in its lane.
struct PixelRow {
    IntW order[largestSide], payload[largestSide];
};

/// Keeps the nearest of what is there and `side` pixels of each splat, of a row from pixel `from` on, at its place in `keys`.
template <int side, int from = 0>
inline void storeRows(Key* keys, const std::int32_t* places, const PixelRow& row) {
#if SCANCAST_SIMD_LEVEL >= 3
    // Lanes 0, 1, 4, 5 and 2, 3, 6, 7 of a column, as keys.
    const auto lower = [&](int c) {
        return reinterpret_cast<Keys4>(
            __builtin_shufflevector(row.payload[c], row.order[c], 0, 8, 1, 9, 4, 12, 5, 13));
    };
    const auto upper = [&](int c) {
        return reinterpret_cast<Keys4>(
            __builtin_shufflevector(row.payload[c], row.order[c], 2, 10, 3, 11, 6, 14, 7, 15));
    };
    const auto put = [&](int lane, Keys4 first, Keys4 second) {
        Key* const low = keys + places[lane];
        Key* const high = keys + places[lane + 4];
        if constexpr (side <= 2) {
            keepNearest(low, __builtin_shufflevector(first, first, 0, 1));
            keepNearest(high, __builtin_shufflevector(first, first, 2, 3));
        } else {
            keepNearest(low, __builtin_shufflevector(first, second, 0, 1, 4, 5));
            keepNearest(high, __builtin_shufflevector(first, second, 2, 3, 6, 7));
        }
    };
    const auto putBoth = [&](int lane, Keys4 a, Keys4 b, Keys4 c, Keys4 d) {
        put(lane, __builtin_shufflevector(a, b, 0, 4, 2, 6), __builtin_shufflevector(c, d, 0, 4, 2, 6));
        put(lane + 1, __builtin_shufflevector(a, b, 1, 5, 3, 7), __builtin_shufflevector(c, d, 1, 5, 3, 7));
    };
#else
    const auto lower = [&](int c) {
        return reinterpret_cast<Keys2>(__builtin_shufflevector(row.payload[c], row.order[c], 0, 4, 1, 5));
    };
    const auto upper = [&](int c) {
        return reinterpret_cast<Keys2>(__builtin_shufflevector(row.payload[c], row.order[c], 2, 6, 3, 7));
    };
    const auto put = [&](int lane, Keys2 first, Keys2 second) {
        Key* const place = keys + places[lane];
        keepNearest(place, first);
        if (side > 2) keepNearest(place + 2, second);
    };
    const auto putBoth = [&](int lane, Keys2 a, Keys2 b, Keys2 c, Keys2 d) {
        put(lane, __builtin_shufflevector(a, b, 0, 2), __builtin_shufflevector(c, d, 0, 2));
        put(lane + 1, __builtin_shufflevector(a, b, 1, 3), __builtin_shufflevector(c, d, 1, 3));
    };
#endif
    using Keys = decltype(lower(0));
    const Keys none = Keys{} + emptyKey;
    putBoth(0, lower(from), side > 1 ? lower(from + 1) : none, side > 2 ? lower(from + 2) : none,
            side > 3 ? lower(from + 3) : none);
    putBoth(2, upper(from), side > 1 ? upper(from + 1) : none, side > 2 ? upper(from + 2) : none,
            side > 3 ? upper(from + 3) : none);
}

/// Splats i, i + 1 …, those of them that are `drawn`; none of these is larger than `side` px.
template <Shape shape, int side, bool colors>
void drawSmall(const Block& b, const Splats& s, int i, IntW drawn, const KeyTile& tile) {
    const FloatW x = load<FloatW>(b.x + i), y = load<FloatW>(b.y + i), half = load<FloatW>(b.half + i);
    const FloatW column = firstPixels<shape>(x, half), row = firstPixels<shape>(y, half), middle = floorOf(y);
    SpriteProfile<shape, wideLanes> profile;
    profile.depth = load<FloatW>(b.depth + i);
    profile.rise = load<FloatW>(s.rise + i);
    // What is not drawn covers nothing, anywhere.
    profile.half = drawn ? half : all(-1.0f);
    profile.half2 = drawn ? half * half : all(-1.0f);
    const FloatW distance = load<FloatW>(s.distance + i);
    const IntW color = load<IntW>(b.color + i);
    const IntW offset = (toInt(row) - tile.y) * tile.stride + (toInt(column) - tile.x);
    alignas(32) std::int32_t places[wideLanes];
    store(places, drawn ? offset : all(0));
    // Each splat has the rows and columns that its own size gives it, whoever stands beside it.
    const auto within = [&](int index, FloatW away) {
        constexpr float outside = 1024;
        if (index < 2) return away;
        return half > pixelsFrom[index] ? away : all(outside);
    };
    FloatW dx[side], dx2[side];
    IntW central[side];
    for (int c = 0; c < side; ++c) {
        dx[c] = within(c, (column + (0.5f + static_cast<float>(c))) - x);
        dx2[c] = dx[c] * dx[c];
        central[c] = (dx[c] > -0.5f) & (dx[c] <= 0.5f) & drawn;
    }
    Key* keys = tile.keys;
    for (int r = 0; r < side; ++r, keys += tile.stride) {
        const FloatW here = row + static_cast<float>(r);
        const FloatW dy = within(r, (here + 0.5f) - y);
        const FloatW dy2 = dy * dy;
        const IntW inMiddle = here == middle;
        PixelRow out;
        for (int c = 0; c < side; ++c) {
            const FloatW square = dx2[c] + dy2;
            // The centre's pixel is covered anyway, at the centre's depth.
            const IntW center = central[c] & inMiddle;
            const FloatW order = center ? profile.depth : profile.orderAt(square);
            const IntW covered = center | profile.covers(dx[c], dy, square);
            out.order[c] = covered ? reinterpret_cast<IntW>(order) : all(emptyOrder);
            if constexpr (colors) {
                out.payload[c] = (toInt(smaller(square * distance, all(255.0f))) << 24) | color;
            } else {
                out.payload[c] = color;
            }
        }
        constexpr int beyondFour = side - 4;
        if constexpr (beyondFour > 0) {
            storeRows<4>(keys, places, out);
            storeRows<beyondFour, 4>(keys + 4, places, out);
        } else {
            storeRows<side>(keys, places, out);
        }
    }
}

/// The block's small splats.
template <Shape shape, bool colors>
void splatSmall(const Block& b, const Splats& s, const KeyTile& tile) {
    for (int i = 0, group = 0; i < b.padded; i += wideLanes, ++group) {
        const IntW drawn = load<IntW>(s.small + i);
        switch (s.sides[group]) {
            case 2:
                drawSmall<shape, 2, colors>(b, s, i, drawn, tile);
                break;
            case 3:
                drawSmall<shape, 3, colors>(b, s, i, drawn, tile);
                break;
            case 4:
                drawSmall<shape, 4, colors>(b, s, i, drawn, tile);
                break;
            case 5:
                drawSmall<shape, 5, colors>(b, s, i, drawn, tile);
                break;
            case 6:
                drawSmall<shape, 6, colors>(b, s, i, drawn, tile);
                break;
            default:
                break;
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
