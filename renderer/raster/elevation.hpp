// Elevations of a raster's cells out of the scan's own points: exactly where they are, all of them, block by block. A block needs the
// leaves that touch it, a few of which are in memory at a time: what it takes depends on neither the cloud's size nor the raster's.
// Pipeline: cloud → leaf points → **elevation** → TIFF. Any thread, which waits for blocks of the cloud; the same numbers on any number of
// them.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <stop_token>
#include <vector>

#include "renderer/device/device.hpp"
#include "renderer/raster/raster_grid.hpp"

namespace scancast {

/// Of a cell without a point, of all values but counts.
inline constexpr float noElevation = std::numeric_limits<float>::lowest();

/// What a block of so many cells takes while it is made, with what comes out.
inline constexpr std::uint64_t bytesPerElevationCell = 24;

struct ElevationOptions {
    CellValue value = CellValue::Highest;
    int fill = 0;  ///< cells
    int threads =
        1;  ///< leaves that are decoded at the same time; more than one: within the caller's task arena
};

/// The cells of a window, row by row from the top: heights in the file's unit, as near as a float is; of CellValue::Count
/// whole numbers as 32 bits without a sign, as they lie in memory. Errors: forLeafPoints()'s.
///
/// A hole is filled out of what is nearest to it in each of the eight directions, no farther than `fill` cells, weighted by the inverse
/// square of its distance; and only where there is something in two directions that are opposite: else it is no hole, but outside of the
/// scan. Nothing outside of the raster has a part in that, nor has anything that was filled itself.
Expected<std::vector<float>> elevationOf(const Cloud& cloud, const SampleFilter& filter,
                                         const RasterGrid& grid, const CellWindow& window,
                                         const ElevationOptions& options, const std::stop_token& stop = {});

}  // namespace scancast
