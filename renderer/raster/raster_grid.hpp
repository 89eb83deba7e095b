// Where a raster's cells lie, and in which order they are made: blocks of whole tiles, row by row from the top left, each with its
// tiles in that order, too. Pure; any thread. Pipeline: request + cloud → **grid** → elevation, orthophoto → TIFF.
//
// Cells count from the top left corner, columns to the right, rows downwards: north is up. A point belongs to the cell
// floor((x - left) / cell), floor((top - y) / cell).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "protocol/raster/raster_request.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Part of a raster, in cells.
struct CellWindow {
    std::int64_t column = 0, row = 0;
    std::int64_t columns = 0, rows = 0;
    std::int64_t cells() const { return columns * rows; }
    bool operator==(const CellWindow&) const = default;
};

struct RasterGrid {
    double left = 0, top = 0;  ///< file coordinates of the outer corner
    double cell = 1;           ///< > 0
    std::int64_t columns = 1, rows = 1;
    int tile = 256;    ///< side, cells
    int block = 1024;  ///< side, cells: a multiple of the tile's

    std::uint64_t cells() const { return std::uint64_t(columns) * std::uint64_t(rows); }
    double right() const { return left + double(columns) * cell; }
    double bottom() const { return top - double(rows) * cell; }
    /// Of a point in file coordinates; may lie outside.
    double columnOf(double x) const { return std::floor((x - left) / cell); }
    double rowOf(double y) const { return std::floor((top - y) / cell); }

    std::int64_t blockColumns() const { return (columns + block - 1) / block; }
    std::int64_t blockRows() const { return (rows + block - 1) / block; }
    std::int64_t blocks() const { return blockColumns() * blockRows(); }
    /// The cells of a block; those at the right and at the bottom may be smaller.
    CellWindow blockAt(std::int64_t index) const;
    std::int64_t tileColumns() const { return (columns + tile - 1) / tile; }
    std::int64_t tileRows() const { return (rows + tile - 1) / tile; }
    std::int64_t tiles() const { return tileColumns() * tileRows(); }
    /// The same window with so many cells more on each side, but for what is outside of the raster.
    CellWindow grown(const CellWindow& window, std::int64_t by) const;
};

/// What there is room and time for.
struct RasterLimits {
    std::uint64_t mostCells = std::uint64_t(1) << 34;
    int largestPicture = 2048;  ///< px on a side, that an orthophoto is drawn in at once
};

/// Of an automatic side: so many times the scan's spacing, rounded to one of 1, 2, 5, 10 …, and made coarser where there would be too many.
inline constexpr double spacingsPerElevationCell = 3, spacingsPerPixel = 1;
inline constexpr std::uint64_t mostAutomaticCells = 100'000'000;

/// InvalidArgument (`cell`) for a raster of too many cells, with a side that would do, (`bbox`) for one that is beside the cloud, or of
/// coordinates in which its cells cannot be told apart; Unsupported where up is not z; Empty for a cloud without points.
Expected<RasterGrid> rasterGrid(const Cloud& cloud, const RasterRequest& request,
                                const RasterLimits& limits = {});

}  // namespace scancast
