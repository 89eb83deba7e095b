// Second half of a splat pass: placed samples → keys. Four ways, chosen by a splat's size:
//   up to 1 px      one key a sample, computed for a whole block, then stored one by one (whole runs only);
//   up to 6 px      a vector of splats at a time (small.hpp), of more than 4 px where several of a vector are;
//   up to guardPx   rows of keys at once, so many for each of a few classes of size, no clipping: what hangs over the tile's
//                   border falls into its guard band;
//   larger          row by row, chunk by chunk, clipped to the tile.
// All give the same keys. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/bounds.hpp"
#include "renderer/device/cpu/kernels/project.hpp"
#include "renderer/device/cpu/kernels/screen.hpp"
#include "renderer/device/cpu/kernels/sprites/small.hpp"
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

/// What a row of fragments needs of its splat, in every lane. `dx` is per lane: px from the centre to the
/// pixel's.
template <Shape shape, int lanes>
struct Fragments {
    SpriteProfile<shape, lanes> profile;
    Float<lanes> dx, dx2, y, distance;
    Int<lanes> color;

    Fragments(const Block& b, const Splats& s, int i) {
        const Float<lanes> zero{};
        y = zero + b.y[i];
        profile.depth = zero + b.depth[i];
        profile.half = zero + b.half[i];
        profile.half2 = profile.half * profile.half;
        profile.rise = zero + s.rise[i];
        distance = zero + s.distance[i];
        color = Int<lanes>{} + static_cast<std::int32_t>(b.color[i]);
    }

    /// Starts a row of lanes at this column of the picture.
    void startColumns(float column, float centerX) {
        dx = (column + 0.5f + laneNumbers<lanes>()) - centerX;
        dx2 = dx * dx;
    }

    void draw(Key* place, float row) const {
        const Float<lanes> dy = (Float<lanes>{} + (row + 0.5f)) - y;
        const Float<lanes> s = dx2 + dy * dy;
        const Int<lanes> covered = profile.covers(dx, dy, s);
        const Int<lanes> order = reinterpret_cast<Int<lanes>>(profile.orderAt(s));
        storeNearest(place, covered ? order : Int<lanes>{} + emptyOrder, payload(s));
    }

    /// The pixel of the centre, covered whatever the footprint, at the centre's depth.
    void drawCenter(Key* place, float row) const {
        const Float<lanes> dy = (Float<lanes>{} + (row + 0.5f)) - y;
        const Int<lanes> center = (dx > -0.5f) & (dx <= 0.5f);
        const Int<lanes> order = reinterpret_cast<Int<lanes>>(profile.depth);
        storeNearest(place, center ? order : Int<lanes>{} + emptyOrder, payload(dx2 + dy * dy));
    }

    /// Where a lane is not covered its payload means nothing, but it must stay an integer.
    Int<lanes> payload(Float<lanes> s) const {
        const Float<lanes> d = s * distance;
        const Float<lanes> bounded = d < 255.0f ? d : Float<lanes>{} + 255.0f;
        return (__builtin_convertvector(bounded, Int<lanes>) << 24) | color;
    }
};

/// The splats of one class: `rows` rows of `chunks` × `lanes` pixels each.
template <Shape shape, int lanes, int chunks, int sizeClass>
void splatRows(const Block& b, const Splats& s, const KeyTile& tile) {
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

/// `splats`: with their shapes.
template <Shape shape>
void splatBlock(const SplatPass& pass, const Block& block, Splats& splats, const KeyTile& tile) {
    collectSplats(block, tile, splats);
    if (pass.payload == SplatPayload::Color) {
        splatSmall<shape, true>(block, splats, tile);
    } else {
        splatSmall<shape, false>(block, splats, tile);
    }
    splatRows<shape, wideLanes, 8 / wideLanes, 0>(block, splats, tile);
    splatRows<shape, wideLanes, 8 / wideLanes, 1>(block, splats, tile);
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

/// Blocks are read, filtered, coloured and projected once for all frames.
template <Shape shape>
void splatSprites(const SplatPass& pass, const SplatRun& run, const FrameTile* frames, int count) {
    const bool pixels = run.largestPx <= 1.0f;
    const bool mayBeLeftOut = !pixels || run.crossesTile;
    SplatPass passes[mostFrames];
    for (int f = 0; f < count; ++f) {
        passes[f] = pass;
        passes[f].centerX = frames[f].centerX;
        passes[f].centerY = frames[f].centerY;
    }
    Block block;
    Splats splats;
    for (std::uint32_t first = 0; first < run.count; first += blockSize) {
        const std::uint32_t left = run.count - first;
        const int samples = left < blockSize ? static_cast<int>(left) : blockSize;
        bool loaded = false;
        for (int f = 0; f < count; ++f) {
            const KeyTile& tile = frames[f].tile;
            if (mayBeLeftOut && leftOut(passes[f], run, first, samples, tile)) continue;
            if (!loaded && pixels) {
                loadBlock<false>(pass, run, first, block);
            } else if (!loaded) {
                loadBlock<true>(pass, run, first, block);
                shapeSplats<shape>(pass, block, splats);
            }
            loaded = true;
            placeBlock(passes[f].centerX, passes[f].centerY, block);
            if (pass.payload == SplatPayload::Surface) setSurfaces(passes[f], run.oriented, block);
            if (pixels) {
                splatPixels(pass, block, tile);
            } else {
                splatBlock<shape>(pass, block, splats, tile);
            }
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
