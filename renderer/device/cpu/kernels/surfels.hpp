// Surfels: discs and ellipses in the tangent planes of their samples; nearest, cell and sum. Part of
// kernels.cpp.
//
// A block is looked at as a whole first (surfelsLeftOut), then made ready (surfel_block.hpp), then drawn one
// surfel after another: small ones as rows of wideLanes pixels, or two of half as many, over their exact bounding box, larger
// ones row by row between the borders of their outline. How a surfel is drawn depends on nothing but the
// surfel, so pictures depend on neither tiles nor runs.
#pragma once

#include "renderer/device/cpu/kernels/bounds.hpp"
#include "renderer/device/cpu/kernels/screen.hpp"
#include "renderer/device/cpu/kernels/surfel_fragments.hpp"

namespace scancast::cpu {
namespace {

/// Largest outline that is drawn over all of its bounding box: the guard band takes what hangs over.
inline constexpr int smallColumns = 8, smallRows = 12;
static_assert(smallColumns <= guard / 2 && smallRows <= guard);

template <Shape shape, Reduction reduction, bool perspective, bool extra>
struct SurfelPainter {
    const SplatPass& pass;
    const Block& b;
    const Surfels& s;
    const KeyTile& tile;

    /// Whether some sum is nearly full.
    bool drawAll() const {
        bool full = false;
        for (int n = 0; n < s.count; ++n) {
            const int i = s.list[n];
            const int columns = s.x1[i] - s.x0[i] + 1, rows = s.y1[i] - s.y0[i] + 1;
            if (columns <= 4 && rows <= smallRows) {
                full |= drawSmall<wideLanes / 4>(i);
            } else if (columns <= smallColumns && rows <= smallRows) {
                full |= drawSmall<1>(i);
            } else {
                full |= drawLarge(i);
            }
        }
        return full;
    }

    /// So many rows at a time.
    template <int rows>
    bool drawSmall(int i) const {
        SurfelFragments<shape, reduction, perspective, extra, wideLanes, rows> f(pass, b, s, i, tile);
        std::int32_t x0 = s.x0[i], y0 = s.y0[i], x1 = s.x1[i], y1 = s.y1[i];
        // Keys in the guard band are nobody's; sums there would be taken for full ones.
        if (reduction == Reduction::Sum) clip(x0, y0, x1, y1);
        for (std::int32_t column = x0; column <= x1; column += f.columns) {
            f.startColumns(column, x1, y1);
            std::int64_t offset = offsetOf(column, y0);
            for (std::int32_t row = y0; row <= y1; row += rows, offset += rows * tile.stride)
                f.draw(offset, row);
        }
        return f.full();
    }

    bool drawLarge(int i) const {
        constexpr int lanes = wideLanes;
        SurfelFragments<shape, reduction, perspective, extra, lanes, 1> f(pass, b, s, i, tile);
        std::int32_t x0 = s.x0[i], y0 = s.y0[i], x1 = s.x1[i], y1 = s.y1[i];
        clip(x0, y0, x1, y1);
        const std::int32_t centerRow = static_cast<std::int32_t>(__builtin_floorf(b.y[i]));
        const std::int32_t centerColumn = static_cast<std::int32_t>(__builtin_floorf(b.x[i]));
        const float inverse = s.inverseY[i], middleY = b.y[i] + s.middleY[i];
        const float middleX = b.x[i] + s.middleX[i];
        for (std::int32_t row = y0; row <= y1; ++row) {
            const float dy = (static_cast<float>(row) + 0.5f) - middleY;
            const float share = dy * inverse;
            const float rest = 1.0f - share * share;
            // A little more than the outline: fragments decide, this only spares some.
            const float half = 0.0625f + s.narrow[i] * __builtin_sqrtf(rest > 0.0f ? rest : 0.0f);
            const float middle = middleX + s.skew[i] * dy;
            std::int32_t first = static_cast<std::int32_t>(__builtin_floorf(within(middle - half + 0.5f)));
            std::int32_t last = static_cast<std::int32_t>(__builtin_floorf(within(middle + half - 0.5f)));
            if (row == centerRow) {
                first = first < centerColumn ? first : centerColumn;
                last = last > centerColumn ? last : centerColumn;
            }
            first = first > x0 ? first : x0;
            last = last < x1 ? last : x1;
            for (std::int32_t column = first; column <= last; column += lanes) {
                f.startColumns(column, last, row);
                f.draw(offsetOf(column, row), row);
            }
        }
        return f.full();
    }

    /// What is far outside any tile, as an integer.
    static float within(float v) {
        v = v > -4194304.0f ? v : -4194304.0f;
        return v < 4194304.0f ? v : 4194304.0f;
    }

    void clip(std::int32_t& x0, std::int32_t& y0, std::int32_t& x1, std::int32_t& y1) const {
        const std::int32_t right = tile.x + tile.width - 1, bottom = tile.y + tile.height - 1;
        x0 = x0 > tile.x ? x0 : tile.x;
        y0 = y0 > tile.y ? y0 : tile.y;
        x1 = x1 < right ? x1 : right;
        y1 = y1 < bottom ? y1 : bottom;
    }

    std::int64_t offsetOf(std::int32_t column, std::int32_t row) const {
        return static_cast<std::int64_t>(row - tile.y) * tile.stride + (column - tile.x);
    }
};

/// No surfel of the block reaches further than this from its centre, cloud units. One large one in a run
/// would have all of its blocks drawn, so each block counts its own.
inline float largestReachOf(const SplatPass& pass, const SplatRun& run, std::uint32_t first, int count) {
    float ratio = 1.0f;
    if (pass.radii != nullptr && run.limits != nullptr) {
        const BlockLimits& limits = run.limits[first / limitsStep];
        ratio = pass.radii[limits.largestRadius] * run.ratioUnit;
        if (limits.plain != 0 && ratio < 1.0f) ratio = 1.0f;
    } else if (pass.radii != nullptr) {
        // The radius' code is the low byte of a sample's last two; 0 and outlierCode are none.
        Shorts8 low = Shorts8{} + std::uint16_t{255}, high{};
        for (int i = 0; i < count; ++i) {
            const Shorts8 code = load<Shorts8>(run.samples + first + i) & std::uint16_t{255};
            const Shorts8 known = code == std::uint16_t{outlierCode} ? Shorts8{} : code;
            low = known < low ? known : low;
            high = known > high ? known : high;
        }
        ratio = pass.radii[high[7]] * run.ratioUnit;
        if (low[7] == 0 && ratio < 1.0f) ratio = 1.0f;
    }
    const float radius = ratio * run.plainRadius * pass.scale;
    return 1.001f * (pass.shape == Shape::Ellipse ? majorPerRadius * radius : radius);
}

/// Grows a block's bounds, which hold its centres, by what its surfels may cover.
inline void growBounds(const SplatPass& pass, float radius, BlockBounds& bounds) {
    const float pixel = 1.0f / pass.pixelsPerUnit;
    const float most = 0.5f * pass.maxPx;
    float half = pass.perspective ? radius * pass.pixelsPerUnit / bounds.depth : radius * pass.pixelsPerUnit;
    half = half < most ? half : most;
    if (pass.reduction == Reduction::Sum && pass.shape == Shape::Disc) half *= pass.reach;
    float margin = half;
    if (pass.perspective) {
        // As discOutline(), for the worst of normals.
        const float limit = largestReach * pass.pixelsPerUnit;
        half = half < limit ? half : limit;
        const auto farther = [](float a, float b) { return a > b ? a : b; };
        const float u = pixel * farther(pass.centerX - bounds.x0, bounds.x1 - pass.centerX);
        const float v = pixel * farther(pass.centerY - bounds.y0, bounds.y1 - pass.centerY);
        const float away = farther(farther(u, v), 0.0f);
        const float shrink = 1.0f - half * half * pixel * pixel;
        margin = 2.0f * (half * half * pixel) * (0.5f + away) / shrink +
                 half * __builtin_sqrtf((1.0f + away * away) / shrink);
    }
    if (pass.shape == Shape::Ellipse) margin += rootOf6 * pass.lowPassPx;
    bounds.x0 -= margin;
    bounds.y0 -= margin;
    bounds.x1 += margin;
    bounds.y1 += margin;
}

/// No fragment of the block counts where the visible depth (or what is drawn already) is nearer than this.
inline float nearestThatCounts(const SplatPass& pass, float radius, float front) {
    const float unitsPerPx = (pass.perspective ? front : 1.0f) / pass.pixelsPerUnit;
    // A radius is cut to maxPx at its own sample's depth, which may be any: only the world's radius bounds
    // it.
    if (pass.shape == Shape::Disc) {
        const bool sums = pass.reduction == Reduction::Sum;
        const float reach = radius * (sums ? pass.reach : 1.0f);
        const float along = pass.tolerance * (1 / leastCosineOfGap);
        return front - reach - (pass.reduction == Reduction::Nearest ? 0.0f : along * radius);
    }
    if (pass.reduction == Reduction::Nearest) return front;
    // dz of the nearest sample; of those behind it grows slower than their depth, while it is below it.
    const float blur = 8.0f * rootOf6 * pass.lowPassPx * unitsPerPx;
    const float range = radius + blur;
    if (pass.perspective && 3.0f * blur > front) return 0.0f;
    return front - 2.0f * (radius + range);
}

/// Whether a block can be left out: it lies in other tiles, or too far behind what is visible.
inline bool surfelsLeftOut(const SplatPass& pass, const SplatRun& run, std::uint32_t first, int count,
                           const KeyTile& tile) {
    // Of the centres: what the run's largest surfel needs says little of the block's.
    SplatRun centers = run;
    centers.largestPx = 0;
    BlockBounds bounds = blockBounds(pass, centers, first, count);
    if (!bounds.known) return false;
    const float radius = largestReachOf(pass, run, first, count);
    growBounds(pass, radius, bounds);
    std::int32_t box[4];
    if (!clampToTile(bounds, tile, box)) return true;
    const float depth = nearestThatCounts(pass, radius, bounds.depth);
    if (!(depth > 0.0f)) return false;
    std::int32_t order;
    __builtin_memcpy(&order, &depth, sizeof order);
    KeyTile visible = tile;
    if (pass.reduction != Reduction::Nearest) visible.keys = const_cast<Key*>(tile.visible);
    return hidden(visible, box[0], box[1], box[2], box[3], order);
}

template <Shape shape, Reduction reduction, bool perspective, bool extra>
std::uint32_t drawSurfels(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    Block block;
    Surfels surfels;
    SplatRun part = run;
    for (std::uint32_t first = 0; first < run.count; first += surfelBlock) {
        const std::uint32_t left = run.count - first;
        const int count = left < surfelBlock ? static_cast<int>(left) : surfelBlock;
        if (surfelsLeftOut(pass, run, first, count, tile)) continue;
        part.count = first + static_cast<std::uint32_t>(count);
        loadBlock<true>(pass, part, first, block);
        placeBlock(pass.centerX, pass.centerY, block);
        if constexpr (shape == Shape::Disc) {
            setUpDiscs<perspective>(pass, run, block, surfels);
        } else {
            setUpEllipses<perspective>(pass, run, first, block, surfels);
        }
        collectSurfels(block, tile, surfels);
        const SurfelPainter<shape, reduction, perspective, extra> painter{pass, block, surfels, tile};
        if (painter.drawAll()) return first + static_cast<std::uint32_t>(count);
    }
    return run.count;
}

template <Shape shape, Reduction reduction, bool extra>
std::uint32_t drawSurfels(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    return pass.perspective ? drawSurfels<shape, reduction, true, extra>(pass, run, tile)
                            : drawSurfels<shape, reduction, false, extra>(pass, run, tile);
}

template <Shape shape>
std::uint32_t drawSurfels(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    if (pass.reduction == Reduction::Sum) {
        return pass.sumNormals ? drawSurfels<shape, Reduction::Sum, true>(pass, run, tile)
                               : drawSurfels<shape, Reduction::Sum, false>(pass, run, tile);
    }
    if (shape == Shape::Disc && pass.reduction == Reduction::Cell) {
        return drawSurfels<Shape::Disc, Reduction::Cell, false>(pass, run, tile);
    }
    return pass.payload == SplatPayload::Color
               ? drawSurfels<shape, Reduction::Nearest, true>(pass, run, tile)
               : drawSurfels<shape, Reduction::Nearest, false>(pass, run, tile);
}

inline bool isSurfel(Shape shape) {
    return shape == Shape::Disc || shape == Shape::Ellipse;
}

std::uint32_t splatSurfels(const SplatPass& pass, const SplatRun& run, const KeyTile& tile) {
    return pass.shape == Shape::Disc ? drawSurfels<Shape::Disc>(pass, run, tile)
                                     : drawSurfels<Shape::Ellipse>(pass, run, tile);
}

}  // namespace
}  // namespace scancast::cpu
