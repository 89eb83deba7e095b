// Hidden point removal: which pixels other points occlude. docs/spec/pyramid.md §4. Part of
// kernels.cpp.
//
// Pixels are taken in columns of one vector's width inside a block, whose pixels all look equally far. First
// only the least depth of each sector is looked at: a row of texels serves many rows of pixels, so that costs
// little, and it decides nearly all: whoever has nobody in front in some sector is visible, and a background
// pixel with somebody in every sector is hidden. Angles are computed for the rest.
#pragma once

#include "renderer/device/cpu/kernels/point_pyramid.hpp"

namespace scancast::cpu {
namespace {

/// Directions in reading order: north-west, north, north-east, west, east, south-west, south, south-east.
inline constexpr int sectors = 8;
/// Sector of a texel of the ring of 12 in a block of 4 × 4; -1 inside the ring.
inline constexpr int sectorOfRing[4][4] = {{0, 1, 1, 2}, {3, -1, -1, 4}, {3, -1, -1, 4}, {5, 6, 6, 7}};
/// Of the 3 × 3 at level 0.
inline constexpr int sectorOfPixel[3][3] = {{0, 1, 2}, {3, -1, 4}, {5, 6, 7}};

/// Top left texel of the ring of 12 around a pixel: floor((pixel + 0.5) / 2^level - 1.5).
inline int ringStart(int pixel, int level) {
    return texelBefore(pixel, level) - 1;
}

/// One value per sector.
struct Sectors {
    FloatW v[sectors];
};

/// Sectors that leave the picture, as masks: those of which some level but the coarsest has no texel. What
/// the coarsest lacks is too far away to matter: leaving those out would fill the background between a
/// picture's border and things near it (measured: 37 % of it at 8 px spacing in 401 × 333; 12 % so).
struct Leaving {
    IntW v[sectors];
};

/// A row of pixels and what they are judged by.
struct Judged {
    FloatW x, y, depth;  ///< the points; in perspective x and y of background pixels mean nothing
    FloatW rayX, rayY;   ///< to a background pixel's point at infinity: (rayX, rayY, 1)
    IntW background;
    FloatW limit;  ///< threshold · number of sectors that count
};

/// Least depth in each sector, of one level's ring.
struct NearestInRing {
    const float* corner;
    std::int32_t stride;
    Sectors& nearest;

    template <int level>
    void run() const {
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                const int sector = sectorOfRing[row][column];
                if (sector < 0) continue;
                const FloatW depth = spread<level>(corner + rowOf(stride, row) + column);
                nearest.v[sector] = smaller(depth, nearest.v[sector]);
            }
        }
    }
};

/// The squared cosine between the direction from x to y and that from y to the eye; 0 where y does not
/// occlude. Occlusion (docs/spec/pyramid.md §4.3) is 1 - cosine; of a neighbour beside or behind it counts
/// as 1.
template <bool perspective>
inline FloatW squaredCosine(const Judged& own, FloatW x, FloatW y, FloatW depth, FloatW square,
                            FloatW minGap) {
    const FloatW gap = own.depth - depth;
    const FloatW dx = own.background ? own.rayX : own.x - x;
    const FloatW dy = own.background ? own.rayY : own.y - y;
    const FloatW dz = own.background ? all(1.0f) : gap;
    const FloatW distance = dx * dx + dy * dy + dz * dz;
    const FloatW along = perspective ? larger(dx * x + dy * y + dz * depth, all(0.0f)) : dz;
    const FloatW squared = along * along / (perspective ? distance * square : distance);
    return gap >= minGap ? squared : all(0.0f);
}

/// The largest squared cosine in each sector, of one level's ring.
template <bool perspective>
struct AnglesInRing {
    const PointLevel& points;
    std::int64_t corner;
    const Judged& own;
    FloatW minGap;
    Sectors& best;

    template <int level>
    void run() const {
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                const int sector = sectorOfRing[row][column];
                if (sector < 0) continue;
                const std::int64_t place = corner + rowOf(points.stride, row) + column;
                const FloatW squared = squaredCosine<perspective>(
                    own, spread<level>(points.x + place), spread<level>(points.y + place),
                    spread<level>(points.depth + place),
                    perspective ? spread<level>(points.square + place) : all(1.0f), minGap);
                best.v[sector] = larger(squared, best.v[sector]);
            }
        }
    }
};

/// The same of the eight pixels around.
template <bool perspective>
void anglesOfPixels(const HiddenPoints& h, int x, int y, const Judged& own, Sectors& best) {
    const PointLevel& points = h.levels[0];
    const Unprojection& u = h.unprojection;
    const FloatW px = toFloat(laneIndices() + x);
    for (int row = 0; row < 3; ++row) {
        const FloatW placedY = placeY(u, all(static_cast<float>(y + row - 1)));
        for (int column = 0; column < 3; ++column) {
            const int sector = sectorOfPixel[row][column];
            if (sector < 0) continue;
            const FloatW depth =
                load<FloatW>(points.depth + rowOf(points.stride, y + row - 1) + x + column - 1);
            const FloatW scale = perspective ? depth : all(1.0f);
            const FloatW pointX = placeX(u, px + static_cast<float>(column - 1)) * scale;
            const FloatW pointY = placedY * scale;
            const FloatW square = pointX * pointX + pointY * pointY + depth * depth;
            best.v[sector] =
                larger(squaredCosine<perspective>(own, pointX, pointY, depth, square, all(h.minGap)),
                       best.v[sector]);
        }
    }
}

/// Sum of 1 - cosine over the sectors that count; `exact`, or an upper bound without roots. Both fall when a
/// cosine grows, in floating point too: whoever is hidden by some of its neighbours is so by all.
template <bool exact>
inline FloatW occlusion(const Sectors& best, const Leaving& leaving) {
    FloatW sum{};
    for (int s = 0; s < sectors; ++s) {
        const FloatW bounded = smaller(best.v[s], all(1.0f));
        const FloatW cosine = exact ? squareRoot<wideLanes>(bounded) : bounded;
        sum += leaving.v[s] ? all(0.0f) : 1.0f - cosine;
    }
    return sum;
}

/// Which of the `open` pixels are hidden, by angles.
template <bool perspective>
IntW hiddenByAngles(const HiddenPoints& h, int x, int y, int reach, const Judged& own, const Leaving& leaving,
                    IntW open) {
    Sectors best{};
    anglesOfPixels<perspective>(h, x, y, own, best);
    for (int level = 1; level <= reach; ++level) {
        const IntW undecided = open & (occlusion<false>(best, leaving) >= own.limit);
        if (bitsOf(undecided) == 0) return open;
        const PointLevel& points = h.levels[level];
        const std::int64_t corner = rowOf(points.stride, ringStart(y, level)) + ringStart(x, level);
        withSpread(level, AnglesInRing<perspective>{points, corner, own, all(h.minGap), best});
    }
    return open & (occlusion<true>(best, leaving) < own.limit);
}

/// A column of pixels inside a block: x is a multiple of wideLanes, y0 one of blockSize.
template <bool perspective>
struct Column {
    const HiddenPoints& h;
    const int x, reach;
    const bool wide;      ///< background is judged, too
    const bool differ;    ///< radii of closings may
    const bool nearEdge;  ///< some sector of some pixel may leave the picture
    IntW west{}, east{};  ///< which pixels' western and eastern sectors do
    /// Least depths in levels k and coarser, for the rows that share them.
    Sectors nearest[maxPyramidLevels + 1];

    IntW sizes{},
        points{};  ///< sums over the visible points: radius of their closing, and how many there are

    Column(const HiddenPoints& hidden, int firstX, int levels, bool background, bool unlike, bool edge)
        : h(hidden), x(firstX), reach(levels), wide(background), differ(unlike), nearEdge(edge) {
        for (FloatW& v : nearest[reach + 1].v) v = all(infinity);
        if (!nearEdge) return;
        const IntW px = laneIndices() + x;
        west = px - 1 < 0;
        east = px + 1 >= h.levels[0].width;
        for (int k = 1; k < reach; ++k) {
            const IntW start = ((((px >> (k - 1)) - 1) >> 1) - 1);
            west |= start < 0;
            east |= start + 3 >= h.levels[k].width;
        }
    }

    /// Sectors that leave the picture from row y.
    Leaving leavingFrom(int y) const {
        bool above = y - 1 < 0, below = y + 1 >= h.levels[0].height;
        for (int k = 1; k < reach; ++k) {
            above |= ringStart(y, k) < 0;
            below |= ringStart(y, k) + 3 >= h.levels[k].height;
        }
        const IntW north = all(above ? -1 : 0), south = all(below ? -1 : 0);
        return {{north | west, north, north | east, west, east, south | west, south, south | east}};
    }

    void findNearest(int y, bool first) {
        for (int k = reach; k >= 1; --k) {
            if (!first && (y & ((1 << (k - 1)) - 1)) != 0) continue;
            nearest[k] = nearest[k + 1];
            const PointLevel& level = h.levels[k];
            const float* const corner = level.depth + rowOf(level.stride, ringStart(y, k)) + ringStart(x, k);
            withSpread(k, NearestInRing{corner, level.stride, nearest[k]});
        }
    }

    /// Of all levels.
    Sectors nearestAround(int y) const {
        Sectors all = nearest[1];
        const float* const own = h.levels[0].depth + rowOf(h.levels[0].stride, y) + x;
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) {
                const int s = sectorOfPixel[row][column];
                if (s < 0) continue;
                const float* const place = own + rowOf(h.levels[0].stride, row - 1) + column - 1;
                all.v[s] = smaller(load<FloatW>(place), all.v[s]);
            }
        }
        return all;
    }

    Judged judged(int y, IntW counting) const {
        const Unprojection& u = h.unprojection;
        Judged own;
        own.depth = load<FloatW>(h.levels[0].depth + rowOf(h.levels[0].stride, y) + x);
        own.background = own.depth > finiteDepths;
        const FloatW placedX = placeX(u, toFloat(laneIndices() + x));
        const FloatW placedY = placeY(u, all(static_cast<float>(y)));
        own.x = perspective ? placedX * own.depth : placedX;
        own.y = perspective ? placedY * own.depth : placedY;
        own.rayX = perspective ? placedX : all(0.0f);
        own.rayY = perspective ? placedY : all(0.0f);
        own.limit = toFloat(counting) * h.threshold;
        return own;
    }

    /// Adds the points of a row.
    void addSizes(FloatW depth, IntW visible) {
        points -= visible;
        if (!differ) return;
        const FloatW size =
            perspective ? h.size.scaled / larger(depth, all(ClosingSize::nearest)) : all(h.size.scaled);
        const FloatW bounded = smaller(larger(size, all(h.size.least)), all(ClosingSize::most));
        sizes += toInt(bounded) & visible;
    }

    IntW labelsOf(int y) {
        const Leaving leaving = nearEdge ? leavingFrom(y) : Leaving{};
        const Sectors around = nearestAround(y);
        const FloatW depth = load<FloatW>(h.levels[0].depth + rowOf(h.levels[0].stride, y) + x);
        IntW counting = all(sectors), open{};
        for (int s = 0; s < sectors; ++s) {
            const IntW occupied = depth - around.v[s] >= h.minGap;
            counting += leaving.v[s];
            open -= ~(occupied | leaving.v[s]);
        }
        const Judged own = judged(y, counting);
        const IntW visible = (toFloat(open) >= own.limit) | (wide ? IntW{} : own.background);
        const IntW sure = reach <= h.sureLevel ? own.background & (open == 0) : IntW{};
        IntW hidden = ~visible & sure;
        const IntW undecided = ~visible & ~sure;
        if (bitsOf(undecided) != 0) {
            hidden |= hiddenByAngles<perspective>(h, x, y, reach, own, leaving, undecided);
        }
        const IntW seen =
            own.background ? all(std::int32_t{backgroundLabel}) : all(std::int32_t{foregroundLabel});
        addSizes(depth, ~(hidden | own.background) & (laneIndices() + x < h.levels[0].width));
        return hidden ? all(std::int32_t{hiddenLabel}) : seen;
    }
};

/// Whether no pixel of the block has a neighbour: the coarsest ring covers the finer ones.
inline bool nothingAround(const HiddenPoints& h, int x0, int y0, int x1, int y1, int reach) {
    if (reach < 3) return false;
    const PointLevel& points = h.levels[reach];
    float nearest = infinity;
    for (int y = ringStart(y0, reach); y <= ringStart(y1 - 1, reach) + 3; ++y) {
        const float* const row = points.depth + rowOf(points.stride, y);
        for (int x = ringStart(x0, reach); x <= ringStart(x1 - 1, reach) + 3; ++x) {
            nearest = row[x] < nearest ? row[x] : nearest;
        }
    }
    return nearest > finiteDepths;
}

template <bool perspective>
void hideBlock(const HiddenPoints& h, int x0, int y0, int y1) {
    const int width = h.levels[0].width, height = h.levels[0].height;
    const int x1 = x0 + blockSize < width ? x0 + blockSize : width;
    const std::int64_t block = rowOf(h.blocksPerRow, y0 >> blockLevel) + (x0 >> blockLevel);
    const int reach = h.reach[block];
    std::int32_t& size = h.sizes[block];
    // Nobody's is larger than that of the nearest depth.
    const bool differ = size > static_cast<std::int32_t>(h.size.least);
    if (nothingAround(h, x0, y0, x1, y1, reach)) {
        // Without neighbours nobody is hidden, and there is no foreground either.
        for (int y = y0; y < y1; ++y) {
            for (int x = x0; x < x1; ++x) h.labels[rowOf(h.labelStride, y) + x] = backgroundLabel;
        }
        size = -1 - size;
        return;
    }
    const int margin = 3 << reach;
    const bool nearEdge = x0 < margin || y0 < margin || x1 + margin > width || y1 + margin > height;
    std::int32_t sizes = 0, points = 0;
    for (int x = x0; x < x1; x += wideLanes) {
        Column<perspective> column(h, x, reach, h.wide[block] != 0, differ, nearEdge);
        for (int y = y0; y < y1; ++y) {
            column.findNearest(y, y == y0);
            storeLabels(h.labels + rowOf(h.labelStride, y) + x, column.labelsOf(y));
        }
        for (int i = 0; i < wideLanes; ++i) {
            sizes += column.sizes[i];
            points += column.points[i];
        }
    }
    if (points == 0) {
        size = -1 - size;
    } else if (differ) {
        size = sizes / points;
    }
}

void hidePoints(const HiddenPoints& h, int y0, int y1) {
    for (int y = y0; y < y1; y += blockSize) {
        const int end = y + blockSize < y1 ? y + blockSize : y1;
        for (int x = 0; x < h.levels[0].width; x += blockSize) {
            if (h.unprojection.perspective) {
                hideBlock<true>(h, x, y, end);
            } else {
                hideBlock<false>(h, x, y, end);
            }
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
