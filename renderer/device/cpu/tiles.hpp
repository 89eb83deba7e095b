// Cuts the area to draw into tiles of about equal work, each drawn by one thread alone: so no pixel needs an
// atomic operation, a tile's keys stay in that core's cache, and drawing, resolving and clearing happen there
// in one go. A run that lies across a border is drawn in both tiles; the cuts follow the work, so that many
// cores find tiles wherever the samples are. Pictures do not depend on the tiles. Pure function.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/device/cpu/prepare.hpp"

namespace scancast::cpu {

struct Tile {
    Rect area;
    std::vector<std::uint32_t> runs;  ///< indices, in the order given
    double work = 0;
};

/// A tile has at most this many pixels: 2 MB of keys. Smaller ones fit the second-level cache but cost more
/// than they save, as more runs lie across borders (measured at 2 million points: 64 Ki pixels 11.6 ms, 256
/// Ki 8.1 ms).
inline constexpr int maxTilePixels = 256 * 1024;

/// Tiles meet at multiples of so many pixels from the area's first one.
inline constexpr int tileSteps = 16;

/// At least `wanted` tiles, as far as tiles do not become tiny; heaviest first. They cover `area` exactly.
std::vector<Tile> cutIntoTiles(const Rect& area, std::span<const PreparedRun> runs, int wanted);

}  // namespace scancast::cpu
