// Second half of a splat pass: placed samples → keys. Three ways, chosen by a splat's size:
//   up to 1 px      one key a sample, computed for a whole block, then stored one by one (whole runs only);
//   up to guardPx   rows of 4 or 8 keys at once, so many rows for each of a few classes of size, no clipping:
//                   what hangs over the tile's border falls into its guard band;
//   larger          row by row, chunk by chunk, clipped to the tile.
// All three give the same keys. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/bounds.hpp"
#include "renderer/device/cpu/kernels/project.hpp"
#include "renderer/device/cpu/kernels/screen.hpp"
#include "renderer/device/cpu/kernels/surfaces.hpp"

namespace scancast::cpu {
namespace {

struct alignas(64) PixelKeys {
    Key keys[blockSize];
    std::int32_t places[blockSize];
};

void splatPixels(const SplatPass& pass, const Block& b, const KeyTile& tile) {
    PixelKeys p;
    const float distanceScale = pass.payload == SplatPayload::Color ? 510.0f : 0.0f;
    IntW unused = static_cast<std::int32_t>(tile.unused - tile.keys) + toInt(laneNumbers<wideLanes>());
    for (int i = 0; i < b.padded; i += wideLanes) {
        const FloatW x = load<FloatW>(b.x + i), y = load<FloatW>(b.y + i);
        const FloatW column = floorOf(x), row = floorOf(y);
        const FloatW dx = (column + 0.5f) - x, dy = (row + 0.5f) - y;
        const IntW left = toInt(column) - tile.x, top = toInt(row) - tile.y;
        const IntW inside =
            (left >= 0) & (left < tile.width) & (top >= 0) & (top < tile.height) & load<IntW>(b.drawable + i);
        const IntW distance = toInt((dx * dx + dy * dy) * distanceScale);
        storeKeys(p.keys + i, load<IntW>(b.depth + i), (distance << 24) | load<IntW>(b.color + i));
        store(p.places + i, inside ? top * tile.stride + left : unused + (i & (unusedKeys - 1)));
    }
    Key* const target = tile.keys;
    for (int i = 0; i < b.count; ++i) {
        Key& now = target[p.places[i]];
        now = p.keys[i] < now ? p.keys[i] : now;
    }
}

/// Splats are drawn by size: so many rows of pixels each, at most. What is larger than the last is clipped
/// and drawn row by row.
inline constexpr int sizeClasses = 6;
inline constexpr int rowsOfClass[sizeClasses - 1] = {2, 3, 4, 6, 8};
static_assert(rowsOfClass[sizeClasses - 2] == static_cast<int>(guardPx));

/// The splats of a block that reach into the tile, and what their rows need beside what the block says.
struct alignas(64) Splats {
    float rise[blockSize];      ///< how fast the order grows; its unit is the profile's
    float distance[blockSize];  ///< distanceScale
    std::int32_t reaches[blockSize];
    std::int32_t sizeClass[blockSize];
    std::uint16_t list[sizeClasses][blockSize];
    int count[sizeClasses] = {};
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

void collectSplats(const Block& b, const KeyTile& tile, Splats& s) {
    const float left = static_cast<float>(tile.x), right = static_cast<float>(tile.x + tile.width);
    const float top = static_cast<float>(tile.y), bottom = static_cast<float>(tile.y + tile.height);
    for (int i = 0; i < b.padded; i += wideLanes) {
        const FloatW half = load<FloatW>(b.half + i);
        const FloatW h = larger(half, all(0.5f));
        const FloatW x = load<FloatW>(b.x + i), y = load<FloatW>(b.y + i);
        const IntW reaches = (x + h >= left) & (x - h <= right) & (y + h >= top) & (y - h <= bottom);
        store(s.reaches + i, reaches & load<IntW>(b.drawable + i));
        IntW sizeClass = all(0);
        for (const int rows : rowsOfClass) sizeClass -= half > 0.5f * static_cast<float>(rows);
        store(s.sizeClass + i, sizeClass);
    }
    for (int i = 0; i < b.count; ++i) {
        const std::int32_t c = s.sizeClass[i];
        s.list[c][s.count[c]] = static_cast<std::uint16_t>(i);
        s.count[c] -= s.reaches[i];
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
        // 8 bits of distance: trunc(this · squared distance in px); pass.hpp.
        const FloatW atLeastAPixel = larger(h, all(0.5f));
        // Ordinals and surfaces take all 32 bits: no distance then.
        const bool colors = pass.payload == SplatPayload::Color;
        store(s.distance + i, colors ? 127.5f / (atLeastAPixel * atLeastAPixel) : all(0.0f));
    }
}

/// What a row of fragments needs of its splat, in every lane. `dx` is per lane: px from the centre to the
/// pixel's.
template <Shape shape, int lanes>
struct Fragments {
    Float<lanes> dx, dx2, y, depth, half, half2, rise, distance;
    Int<lanes> color;

    Fragments(const Block& b, const Splats& s, int i) {
        const Float<lanes> zero{};
        y = zero + b.y[i];
        depth = zero + b.depth[i];
        half = zero + b.half[i];
        half2 = half * half;
        rise = zero + s.rise[i];
        distance = zero + s.distance[i];
        color = Int<lanes>{} + static_cast<std::int32_t>(b.color[i]);
    }

    /// Starts a row of lanes at this column of the picture.
    void startColumns(float column, float centerX) {
        dx = (column + 0.5f + laneNumbers<lanes>()) - centerX;
        dx2 = dx * dx;
    }

    Int<lanes> covers(Float<lanes> s, Float<lanes> dy) const {
        if constexpr (isSquare<shape>) {
            return (dx > -half) & (dx <= half) & (dy > -half) & (dy <= half);
        } else {
            return s <= half2;
        }
    }

    Float<lanes> orderAt(Float<lanes> s) const {
        if constexpr (isSphere<shape>) {
            const Float<lanes> rest = Float<lanes>{} + 1.0f - s / half2;
            const Float<lanes> bounded = rest > 0.0f ? rest : Float<lanes>{};
            return depth + rise * (Float<lanes>{} + 1.0f - squareRoot<lanes>(bounded));
        } else if constexpr (isCone<shape>) {
            return depth + rise * squareRoot<lanes>(s);
        } else if constexpr (!isFlat<shape>) {
            return depth + rise * s;
        } else {
            return depth;
        }
    }

    void draw(Key* place, float row) const {
        const Float<lanes> dy = (Float<lanes>{} + (row + 0.5f)) - y;
        const Float<lanes> s = dx2 + dy * dy;
        const Int<lanes> covered = covers(s, dy);
        const Float<lanes> order = orderAt(s);
        const Int<lanes> bits = covered ? reinterpret_cast<Int<lanes>>(order) : Int<lanes>{} + 0x7fffffff;
        storeNearest(place, bits, payload(s));
    }

    /// The pixel of the centre, covered whatever the footprint, at the centre's depth.
    void drawCenter(Key* place, float row) const {
        const Float<lanes> dy = (Float<lanes>{} + (row + 0.5f)) - y;
        const Int<lanes> center = (dx > -0.5f) & (dx <= 0.5f);
        const Int<lanes> bits = center ? reinterpret_cast<Int<lanes>>(depth) : Int<lanes>{} + 0x7fffffff;
        storeNearest(place, bits, payload(dx2 + dy * dy));
    }

    /// Two by two pixels, which hold the centre's: lanes 0, 1 above 2, 3; `dx` as startFour() set it.
    void startFour(float column, float centerX) {
        const Float<4> columns = {0, 1, 0, 1};
        dx = (column + 0.5f + columns) - centerX;
        dx2 = dx * dx;
    }

    void drawFour(Key* above, Key* below, float row) const {
        const Float<4> rows = {0, 0, 1, 1};
        const Float<4> dy = (row + 0.5f + rows) - y;
        const Float<4> s = dx2 + dy * dy;
        const Int<4> center = (dx > -0.5f) & (dx <= 0.5f) & (dy > -0.5f) & (dy <= 0.5f);
        const Int<4> bits = covers(s, dy) ? reinterpret_cast<Int<4>>(orderAt(s)) : Int<4>{} + 0x7fffffff;
        const Int<4> order = center ? reinterpret_cast<Int<4>>(depth) : bits;
        const Int<4> low = payload(s);
        keepNearest(above, reinterpret_cast<Keys2>(__builtin_shufflevector(low, order, 0, 4, 1, 5)));
        keepNearest(below, reinterpret_cast<Keys2>(__builtin_shufflevector(low, order, 2, 6, 3, 7)));
    }

    /// Where a lane is not covered its payload means nothing, but it must stay an integer.
    Int<lanes> payload(Float<lanes> s) const {
        const Float<lanes> d = s * distance;
        const Float<lanes> bounded = d < 255.0f ? d : Float<lanes>{} + 255.0f;
        return (__builtin_convertvector(bounded, Int<lanes>) << 24) | color;
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

/// Splats of up to two pixels.
template <Shape shape>
void splatTiny(const Block& b, const Splats& s, const KeyTile& tile) {
    const std::int64_t stride = tile.stride;
    for (int n = 0; n < s.count[0]; ++n) {
        const int i = s.list[0][n];
        Fragments<shape, 4> f(b, s, i);
        const float column = firstPixel<shape>(b.x[i], b.half[i]);
        const float row = firstPixel<shape>(b.y[i], b.half[i]);
        Key* const above = tile.keys + (static_cast<std::int32_t>(row) - tile.y) * stride +
                           (static_cast<std::int32_t>(column) - tile.x);
        f.startFour(column, b.x[i]);
        f.drawFour(above, above + stride, row);
    }
}

/// The splats of one class: `rows` rows of `chunks` × `lanes` pixels each.
template <Shape shape, int lanes, int chunks, int sizeClass>
void splatSmall(const Block& b, const Splats& s, const KeyTile& tile) {
    constexpr int rows = rowsOfClass[sizeClass];
    static_assert(rows <= lanes * chunks);
    const std::int64_t stride = tile.stride;
    for (int n = 0; n < s.count[sizeClass]; ++n) {
        const int i = s.list[sizeClass][n];
        Fragments<shape, lanes> f(b, s, i);
        const float column = firstPixel<shape>(b.x[i], b.half[i]);
        const float row = firstPixel<shape>(b.y[i], b.half[i]);
        const float centerRow = __builtin_floorf(b.y[i]);
        Key* const first = tile.keys + (static_cast<std::int32_t>(row) - tile.y) * stride +
                           (static_cast<std::int32_t>(column) - tile.x);
        Key* const center = first + static_cast<std::int32_t>(centerRow - row) * stride;
        for (int c = 0; c < chunks; ++c) {
            f.startColumns(column + static_cast<float>(c * lanes), b.x[i]);
            Key* place = first + c * lanes;
            float r = row;
            for (int j = 0; j < rows; ++j, place += stride, r += 1.0f) f.draw(place, r);
            f.drawCenter(center + c * lanes, centerRow);
        }
    }
}

template <Shape shape>
void splatLarge(const Block& b, const Splats& s, const KeyTile& tile) {
    constexpr int lanes = wideLanes;
    const std::int32_t right = tile.x + tile.width, bottom = tile.y + tile.height;
    for (int n = 0; n < s.count[sizeClasses - 1]; ++n) {
        const int i = s.list[sizeClasses - 1][n];
        Fragments<shape, lanes> f(b, s, i);
        const float x = b.x[i], y = b.y[i], h = b.half[i];
        std::int32_t x0 = static_cast<std::int32_t>(firstPixel<shape>(x, h));
        std::int32_t x1 = static_cast<std::int32_t>(__builtin_floorf(x + h + 0.5f));
        std::int32_t y0 = static_cast<std::int32_t>(firstPixel<shape>(y, h));
        std::int32_t y1 = static_cast<std::int32_t>(__builtin_floorf(y + h + 0.5f));
        x0 = x0 < tile.x ? tile.x : x0;
        y0 = y0 < tile.y ? tile.y : y0;
        x1 = x1 < right - 1 ? x1 : right - 1;
        y1 = y1 < bottom - 1 ? y1 : bottom - 1;
        const std::int32_t centerRow = static_cast<std::int32_t>(__builtin_floorf(y));
        for (std::int32_t column = x0; column <= x1; column += lanes) {
            f.startColumns(static_cast<float>(column), x);
            Key* place = tile.keys + static_cast<std::int64_t>(y0 - tile.y) * tile.stride + (column - tile.x);
            for (std::int32_t row = y0; row <= y1; ++row, place += tile.stride) {
                f.draw(place, static_cast<float>(row));
                if (row == centerRow) f.drawCenter(place, static_cast<float>(row));
            }
        }
    }
}

template <Shape shape>
void splatBlock(const SplatPass& pass, const Block& block, const KeyTile& tile) {
    Splats splats;
    collectSplats(block, tile, splats);
    shapeSplats<shape>(pass, block, splats);
    splatTiny<shape>(block, splats, tile);
    splatSmall<shape, 4, 1, 1>(block, splats, tile);
    splatSmall<shape, 4, 1, 2>(block, splats, tile);
    splatSmall<shape, wideLanes, 8 / wideLanes, 3>(block, splats, tile);
    splatSmall<shape, wideLanes, 8 / wideLanes, 4>(block, splats, tile);
    splatLarge<shape>(block, splats, tile);
}

/// Whether a block can be left out: it lies in other tiles, or behind what is drawn already.
bool leftOut(const SplatPass& pass, const SplatRun& run, std::uint32_t first, int count,
             const KeyTile& tile) {
    const BlockBounds bounds = blockBounds(pass, run, first, count);
    if (!bounds.known) return false;
    std::int32_t box[4];
    if (!clampToTile(bounds, tile, box)) return true;
    std::int32_t order;
    __builtin_memcpy(&order, &bounds.depth, sizeof order);
    return hidden(tile, box[0], box[1], box[2], box[3], order);
}

template <Shape shape>
void splatSprites(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    Block block;
    for (std::uint32_t first = 0; first < run.count; first += blockSize) {
        const std::uint32_t left = run.count - first;
        const int count = left < blockSize ? static_cast<int>(left) : blockSize;
        if ((run.largestPx > 1.0f || run.crossesTile) && leftOut(pass, run, first, count, tile)) continue;
        loadBlock(pass, run, first, block);
        if (pass.payload == SplatPayload::Surface) setSurfaces(pass, run.oriented, block);
        if (run.largestPx <= 1.0f) {
            splatPixels(pass, block, tile);
        } else {
            splatBlock<shape>(pass, block, tile);
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
