// Closing of the background: which background pixels are holes between points. docs/spec/pyramid.md §4.4. Part
// of kernels.cpp.
//
// Dilation and erosion by discs are distances to the nearest point, and to the nearest pixel that no point
// covers: first along columns, for all radii at once, then across them. All numbers are integers.
#pragma once

#include "renderer/device/cpu/kernels/texels.hpp"

namespace scancast::cpu {
namespace {

/// Bytes of as many pixels as a vector holds.
inline constexpr int wideBytes = 4 * wideLanes;
typedef std::uint8_t Bytes __attribute__((vector_size(wideBytes)));
/// Distances along a column stop here: nobody looks so far.
inline constexpr std::uint8_t tooFar = widestClosing + 1;

/// 255 where the picture has a sample.
struct SampleAt {
    const Closing& c;
    Bytes operator()(int x, int y) const {
        const float* const depth = c.depth + rowOf(c.depthStride, y) + x;
        std::uint8_t found[wideBytes];
        for (int i = 0; i < wideBytes; i += wideLanes)
            storeLabels(found + i, load<FloatW>(depth + i) < finiteDepths);
        return load<Bytes>(found);
    }
};

/// 255 where no point covers a pixel.
struct UncoveredAt {
    const Closing& c;
    Bytes operator()(int x, int y) const {
        return reinterpret_cast<Bytes>(load<Bytes>(c.covered + rowOf(c.stride, y) + x) == 0);
    }
};

inline Bytes fewer(Bytes a, Bytes b) {
    return a < b ? a : b;
}

/// Distances to the nearest one above or below.
template <class Found>
void distancesAlongColumns(const Closing& c, const Found& found, int x0, int x1) {
    const Bytes most = Bytes{} + tooFar;
    for (int x = x0; x < x1; x += wideBytes) {
        Bytes steps = most;
        for (int y = 0; y < c.height; ++y) {
            steps = fewer(steps + 1, most) & ~found(x, y);
            store(c.distance + rowOf(c.stride, y) + x, steps);
        }
        for (int y = c.height; y-- > 0;) {
            std::uint8_t* const place = c.distance + rowOf(c.stride, y) + x;
            const Bytes above = load<Bytes>(place);
            steps = fewer(fewer(steps + 1, most), above);
            store(place, steps);
        }
    }
}

void closingColumns(const Closing& c, bool ofUncovered, int x0, int x1) {
    if (ofUncovered) {
        distancesAlongColumns(c, UncoveredAt{c}, x0, x1);
    } else {
        distancesAlongColumns(c, SampleAt{c}, x0, x1);
    }
}

/// A row of a block as bytes.
typedef std::uint8_t BlockRow __attribute__((vector_size(blockSize)));

inline bool allOf(BlockRow mask) {
    const auto halves = reinterpret_cast<__attribute__((vector_size(16))) long long>(mask);
    return (halves[0] & halves[1]) == -1;
}

/// Sizes of a block and those around it; beyond the border, the nearest inside.
struct Sizes {
    std::int32_t at[3][3];
    int narrowest = widestClosing;
    int widest = 0;       ///< px: no pixel of the block has a wider radius
    bool beyond = false;  ///< some pixel's may be too wide for a closing
    bool alike = true;

    Sizes(const Closing& c, int column, int row) {
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                const int x = clamped(column + i - 1, c.blocksPerRow), y = clamped(row + j - 1, c.blockRows);
                const std::int32_t size = at[j][i] = c.sizes[rowOf(c.blocksPerRow, y) + x];
                widest = size >> 3 > widest ? size >> 3 : widest;
                narrowest = size >> 3 < narrowest ? size >> 3 : narrowest;
                alike &= size == at[0][0];
            }
        }
        beyond = widest > widestClosing;
        widest = beyond ? widestClosing : widest;
    }
    static int clamped(int i, int count) { return i < 0 ? 0 : i >= count ? count - 1 : i; }
};

/// Radii of a row of pixels inside a block: bilinear between the middles of blocks.
struct Radii {
    IntW eighths, limit;  ///< limit: squares of distances up to it are within the radius

    Radii(const Sizes& sizes, int x, int y) : eighths(all(sizes.at[1][1])) {
        if (!sizes.alike) {
            // A vector lies on one side of the block's middle.
            const int east = (x & (blockSize - 1)) >> (blockLevel - 1);
            const int south = (y & (blockSize - 1)) >> (blockLevel - 1);
            const int below = (2 * y - (blockSize - 1)) & 31;
            const auto column = [&](int i) {
                return sizes.at[south][i] * (32 - below) + sizes.at[south + 1][i] * below;
            };
            const IntW beside = (laneIndices() * 2 + (2 * x - (blockSize - 1))) & 31;
            eighths = (column(east) * (32 - beside) + column(east + 1) * beside) >> 10;
        }
        const IntW wished = eighths >> 3;
        const IntW radius = wished < widestClosing ? wished : all(widestClosing);
        limit = radius * radius + radius;
    }
    /// Too wide for a closing.
    IntW beyond() const { return (eighths >> 3) > widestClosing; }
};

/// Which of the pixels that `asked` have one in the row whose distance along its column is small enough.
inline IntW within(const std::uint8_t* distances, IntW limit, IntW asked, int widest) {
    const auto near = [&](int offset) {
        const IntW along = loadLabels(distances + offset);
        return along * along + offset * offset <= limit;
    };
    IntW found = near(0);
    for (int offset = 1; offset <= widest && bitsOf(asked & ~found) != 0; ++offset)
        found |= near(offset) | near(-offset);
    return found;
}

/// Discs by columns: at an offset, distances along the column up to it are within.
struct DiscTable {
    std::uint8_t along[widestClosing + 1][widestClosing + 1] = {};

    constexpr DiscTable() {
        for (int radius = 0; radius <= widestClosing; ++radius) {
            for (int x = 0, y = radius; x <= radius; ++x) {
                while (y > 0 && x * x + y * y > radius * radius + radius) --y;
                along[radius][x] = std::uint8_t(y);
            }
        }
    }
};
inline constexpr DiscTable discTable;

struct Disc {
    int radius;
    const std::uint8_t* along;
    explicit Disc(int px) : radius(px), along(discTable.along[px]) {}
};

/// As within(), where all radii of the block are the same: a row of it at once.
inline BlockRow withinDisc(const std::uint8_t* distances, const Disc& disc, BlockRow asked) {
    const auto near = [&](int offset) {
        return reinterpret_cast<BlockRow>(load<BlockRow>(distances + offset) <=
                                          disc.along[offset < 0 ? -offset : offset]);
    };
    BlockRow found = near(0);
    for (int offset = 1; offset <= disc.radius && !allOf(found | ~asked); ++offset)
        found |= near(offset) | near(-offset);
    return found;
}

/// A block of pixels.
struct ClosingBlock {
    const Closing& c;
    const int column, row, y1;
    const Sizes sizes;
    const Disc narrow, wide;

    ClosingBlock(const Closing& closing, int blockColumn, int blockRow)
        : c(closing),
          column(blockColumn),
          row(blockRow),
          y1((row + 1) * blockSize < c.height ? (row + 1) * blockSize : c.height),
          sizes(c, column, row),
          narrow(sizes.narrowest),
          wide(sizes.widest) {}

    /// Whether rows can be taken at once: all of the block inside the picture, no radius too wide.
    bool regular() const { return !sizes.beyond && (column + 1) * blockSize <= c.width; }

    /// Whether a block within the radius has what is looked for.
    template <class Has>
    bool anyAround(const Has& has) const {
        const int reach = (sizes.widest + blockSize - 1) >> blockLevel;
        for (int j = row - reach; j <= row + reach; ++j) {
            for (int i = column - reach; i <= column + reach; ++i) {
                if (i < 0 || j < 0 || i >= c.blocksPerRow || j >= c.blockRows) continue;
                if (has(i, j)) return true;
            }
        }
        return false;
    }

    /// Calls work(x) for the vectors of pixels of a row.
    template <class Work>
    void overVectors(const Work& work) const {
        for (int x = column * blockSize; x < (column + 1) * blockSize && x < c.width; x += wideLanes) work(x);
    }

    /// Of a row, where the narrowest disc of the block and the widest agree on all that is asked.
    bool decided(int y, BlockRow asked, BlockRow& found) const {
        const std::uint8_t* const distances = c.distance + rowOf(c.stride, y) + column * blockSize;
        found = withinDisc(distances, narrow, asked);
        const BlockRow left = asked & ~found;
        return narrow.radius == wide.radius || allOf(~left) ||
               allOf(~(withinDisc(distances, wide, left) & left));
    }

    /// Dilation: 1 where a point is within the radius.
    void cover() const {
        const bool any =
            anyAround([&](int i, int j) { return c.nearest[rowOf(c.nearestStride, j) + i] < finiteDepths; });
        bool uncovered = false;
        for (int y = row * blockSize; y < y1; ++y) {
            const std::int64_t first = rowOf(c.stride, y);
            BlockRow found{};
            if (regular() && (!any || decided(y, ~BlockRow{}, found))) {
                uncovered |= !allOf(found);
                store(c.covered + first + column * blockSize, found & 1);
                continue;
            }
            overVectors([&](int x) {
                const IntW inside = laneIndices() + x < c.width;
                const Radii radii(sizes, x, y);
                const IntW near = within(c.distance + first + x, radii.limit, inside, sizes.widest);
                uncovered |= bitsOf(inside & ~near) != 0;
                // Beyond the border nothing is uncovered.
                storeLabels(c.covered + first + x, (near | ~inside) & 1);
            });
        }
        c.uncovered[rowOf(c.blocksPerRow, row) + column] = uncovered ? 1 : 0;
    }

    /// Erosion: background pixels that nothing uncovered is near to are holes.
    void close() const {
        const bool any =
            anyAround([&](int i, int j) { return c.uncovered[rowOf(c.blocksPerRow, j) + i] != 0; });
        // Where background was judged before, labels do not tell it from hidden points.
        const bool byRows =
            (!any && !sizes.beyond) || (regular() && c.wide[rowOf(c.blocksPerRow, row) + column] == 0);
        for (int y = row * blockSize; y < y1; ++y) {
            if (byRows && closeRow(y, any)) continue;
            overVectors([&](int x) { closeVector(x, y, any); });
        }
    }

    bool closeRow(int y, bool any) const {
        std::uint8_t* const labels = c.labels + rowOf(c.labelStride, y) + column * blockSize;
        const BlockRow seen = load<BlockRow>(labels);
        const BlockRow background = reinterpret_cast<BlockRow>(seen == backgroundLabel);
        if (allOf(~background)) return true;
        BlockRow open{};
        if (any && !decided(y, background, open)) return false;
        static_assert(hiddenLabel == 0);
        store(labels, seen & (~background | open));
        return true;
    }

    void closeVector(int x, int y, bool any) const {
        const IntW background = load<FloatW>(c.depth + rowOf(c.depthStride, y) + x) > finiteDepths;
        if (bitsOf(background) == 0) return;
        const Radii radii(sizes, x, y);
        const IntW asked = background & ~radii.beyond();
        IntW open{};
        if (any) open = within(c.distance + rowOf(c.stride, y) + x, radii.limit, asked, sizes.widest);
        std::uint8_t* const labels = c.labels + rowOf(c.labelStride, y) + x;
        const IntW decision = open ? all(std::int32_t{backgroundLabel}) : all(std::int32_t{hiddenLabel});
        storeLabels(labels, asked ? decision : loadLabels(labels));
    }
};

void closingRows(const Closing& c, bool ofUncovered, int row) {
    for (int column = 0; column < c.blocksPerRow; ++column) {
        const ClosingBlock block(c, column, row);
        if (ofUncovered) {
            block.close();
        } else {
            block.cover();
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
