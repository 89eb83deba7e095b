// Screen-aligned splats, blended: the `sum` pass of hqs, docs/spec/sprites.md §6. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/bounds.hpp"
#include "renderer/device/cpu/kernels/project.hpp"
#include "renderer/device/cpu/kernels/sprites/nearest.hpp"
#include "renderer/device/cpu/kernels/sums.hpp"
#include "renderer/device/cpu/kernels/surfaces.hpp"
#include "renderer/device/cpu/kernels/view_normals.hpp"

namespace scancast::cpu {
namespace {

/// What lies further behind the visible surface than this adds nothing: ε = 2R.
inline constexpr float circleTolerance = 2.0f;

/// One splat's fragments, row by row, clipped to the tile.
template <int lanes, bool normals>
void sumCircle(const Block& b, int i, float farthest, const Addends<lanes>& addends,
               const OfSurface<lanes>& surface, const KeyTile& tile, Int<lanes>& full) {
    const float x = b.x[i], y = b.y[i], h = b.half[i];
    const std::int32_t centerColumn = static_cast<std::int32_t>(__builtin_floorf(x));
    const std::int32_t centerRow = static_cast<std::int32_t>(__builtin_floorf(y));
    const auto last = [](float c, float half) {
        const float border = __builtin_floorf((c + half) - 0.5f), middle = __builtin_floorf(c);
        return static_cast<std::int32_t>(border > middle ? border : middle);
    };
    const std::int32_t left = static_cast<std::int32_t>(firstPixel<Shape::FlatCircle>(x, h));
    const std::int32_t top = static_cast<std::int32_t>(firstPixel<Shape::FlatCircle>(y, h));
    const std::int32_t right = last(x, h), bottom = last(y, h);
    const std::int32_t x0 = left > tile.x ? left : tile.x, y0 = top > tile.y ? top : tile.y;
    const std::int32_t x1 = right < tile.x + tile.width ? right : tile.x + tile.width - 1;
    const std::int32_t y1 = bottom < tile.y + tile.height ? bottom : tile.y + tile.height - 1;
    const Float<lanes> half2 = Float<lanes>{} + h * h;
    const float inverse = 1.0f / (h * h);
    for (std::int32_t column = x0; column <= x1; column += lanes) {
        const Float<lanes> dx = (static_cast<float>(column) + 0.5f + laneNumbers<lanes>()) - x;
        const Float<lanes> dx2 = dx * dx;
        const Int<lanes> columns = __builtin_convertvector(laneNumbers<lanes>(), Int<lanes>) + column;
        for (std::int32_t row = y0; row <= y1; ++row) {
            const float dy = (static_cast<float>(row) + 0.5f) - y;
            const Float<lanes> s = dx2 + dy * dy;
            const std::int64_t offset =
                static_cast<std::int64_t>(row - tile.y) * tile.stride + (column - tile.x);
            const Int<lanes> center = (columns == centerColumn) & (row == centerRow ? -1 : 0);
            const Int<lanes> inside = ((s <= half2) | center) & (columns <= x1);
            // Seen from here the splat must not lie behind the surface: d ≤ d_vis + 2R.
            const Int<lanes> covered = inside & (farthest <= loadOrders<lanes>(tile.visible + offset));
            const Float<lanes> rest = 1.0f - s * inverse;
            const Float<lanes> bounded = rest > 0.0f ? rest : Float<lanes>{};
            const Float<lanes> weight = bounded * squareRoot<lanes>(bounded);
            const Int<lanes> whole = quantiseWeight<lanes>(weight, covered);
            if (normals && surface.mayTurn) {
                const Int<lanes> turned = surface.turned(loadPayloads<lanes>(tile.visible + offset));
                addFragments<lanes, normals, true>(tile, offset, whole, addends, turned, full);
            } else {
                addFragments<lanes, normals, false>(tile, offset, whole, addends, Int<lanes>{}, full);
            }
        }
    }
}

template <int lanes, bool normals>
bool sumBlock(const SplatPass& pass, bool oriented, const Block& b, const KeyTile& tile) {
    std::int32_t reaches[blockSize];
    for (int i = 0; i < b.padded; i += wideLanes) store(reaches + i, reachesTile(b, i, tile));
    ViewNormals view;
    std::uint32_t surfaces[blockSize];
    if constexpr (normals) {
        viewNormals(pass, oriented, b, view);
        spriteSurfaces(view, b.padded, surfaces);
    }
    Int<lanes> full{};
    for (int i = 0; i < b.count; ++i) {
        if (reaches[i] == 0) continue;
        float radius = b.half[i] * pass.radiusPerPixel;
        if (pass.perspective) radius *= b.depth[i];
        Addends<lanes> addends(b.color[i]);
        OfSurface<lanes> surface;
        if constexpr (normals) {
            addends.setNormal(view.x[i], view.y[i], view.z[i]);
            surface = {static_cast<std::int32_t>(surfaces[i]), view.anySide[i] != 0};
        }
        sumCircle<lanes, normals>(b, i, b.depth[i] - circleTolerance * radius, addends, surface, tile, full);
    }
    return anyOf<lanes>(full);
}

template <bool normals>
bool sumBlock(const SplatPass& pass, const SplatRun& run, const Block& b, const KeyTile& tile) {
    if (run.largestPx <= 3) return sumBlock<4, normals>(pass, run.oriented, b, tile);
    return sumBlock<wideLanes, normals>(pass, run.oriented, b, tile);
}

/// Whether a block lies in other tiles, or so far behind what is visible that it adds nothing.
bool sumLeftOut(const SplatPass& pass, const SplatRun& run, std::uint32_t first, int count,
                const KeyTile& tile) {
    const BlockBounds bounds = blockBounds(pass, run, first, count);
    if (!bounds.known) return false;
    std::int32_t box[4];
    if (!clampToTile(bounds, tile, box)) return true;
    float radius = 0.5f * run.largestPx * pass.radiusPerPixel;
    // A block's size is small against its distance, but not nothing: twice the tolerance at its front.
    if (pass.perspective) radius *= 2.0f * bounds.depth;
    const float depth = bounds.depth - circleTolerance * radius;
    if (!(depth > 0.0f)) return false;
    std::int32_t order;
    __builtin_memcpy(&order, &depth, sizeof order);
    KeyTile visible = tile;
    visible.keys = const_cast<Key*>(tile.visible);
    return hidden(visible, box[0], box[1], box[2], box[3], order);
}

std::uint32_t sumCircles(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    Block block;
    for (std::uint32_t first = 0; first < run.count; first += blockSize) {
        const std::uint32_t left = run.count - first;
        const int count = left < blockSize ? static_cast<int>(left) : blockSize;
        if (sumLeftOut(pass, run, first, count, tile)) continue;
        loadBlock<true>(pass, run, first, block);
        placeBlock(pass.centerX, pass.centerY, block);
        const bool full = pass.sumNormals ? sumBlock<true>(pass, run, block, tile)
                                          : sumBlock<false>(pass, run, block, tile);
        if (full) return first + static_cast<std::uint32_t>(count);
    }
    return run.count;
}

}  // namespace
}  // namespace scancast::cpu
