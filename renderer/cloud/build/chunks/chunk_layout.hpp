// How a cloud is divided into chunks that fit in memory: the top of the octree, split at counting-grid
// boundaries nearest the average, and which chunk every cell belongs to. Pipeline: counting grid → **chunk
// layout** → chunks. Source: docs/spec/hierarchy.md §2. Pure function; the result depends
// on the counts alone.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "renderer/cloud/build/chunks/counting_grid.hpp"

namespace scancast {

/// A set of the top: its children, or a chunk.
struct LayoutNode {
    std::vector<LayoutNode> children;
    std::uint32_t chunk = 0;  ///< without children: which
};

struct ChunkLayout {
    struct Chunk {
        std::uint64_t points = 0;
        std::uint64_t halo = 0;  ///< points of other chunks near its border
    };
    /// Where a cell's points go: its chunk, and those chunks whose halo it is part of.
    struct Destination {
        std::uint32_t chunk = 0;
        std::uint32_t firstHalo = 0, halos = 0;  ///< a range of haloChunks
    };

    CellFrame frame;
    LayoutNode root;
    std::vector<Chunk> chunks;  ///< in the order of a walk through the top, depth first
    std::vector<std::uint32_t> haloChunks;

    const Destination& destination(CellKey key) const { return destinations[*index.find(key)]; }

    CellTable index{};  ///< from key to destinations
    std::vector<Destination> destinations;
};

/// Sets above chunkPoints are split; one cell is never. With `halo`, a chunk's halo is all points in the
/// cells around it; cells are taken so large that an occupied one holds 64 points on average.
ChunkLayout layOutChunks(const CellFrame& frame, std::vector<CountedCell> cells, const Grid& grid,
                         std::uint64_t chunkPoints, bool halo);

}  // namespace scancast
