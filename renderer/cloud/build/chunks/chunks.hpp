// Chunks: sets of neighbouring points, each small enough to become a subtree in memory. Pipeline: staging →
// counting grid → chunk layout → **chunks** → octree builder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "renderer/cloud/build/chunks/chunk_sorting.hpp"

namespace scancast {

struct ChunkOptions {
    std::uint64_t chunkPoints = 1 << 20;
    std::size_t rowBytes = 0;
    bool halo = false;
};

/// Counts and divides points that lie in `box`, and grows the top of the tree below `root`. Chunks that are
/// still too large, because their points crowd in one cell, are divided again. In the order of the tree. Uses
/// the caller's TBB arena. Errors: the portions' and the workspace's; ResourceLimit for very many points at
/// exactly one place; Cancelled.
Expected<std::vector<Chunk>> divide(PointPortions& portions, std::uint64_t points, const GridBox& box,
                                    BuildNode& root, const Grid& grid, const ChunkOptions& options,
                                    Workspace& workspace, ProgressMeter& progress,
                                    const std::stop_token& stop);

// Its steps, for several processes that share them.

/// A chunk has at most so many points, unless they cannot be told apart.
inline std::uint64_t mostChunkPoints(const GridBox& box, std::uint64_t points, const ChunkOptions& options) {
    return box.isPoint() ? points : options.chunkPoints;
}
/// Grows the top of the tree as it is laid out; the places of the chunks, in their order.
std::vector<BuildNode*> growTop(const LayoutNode& layout, BuildNode& root);
/// Divides those again that have more than `most` points; each has its place in the tree already.
Expected<std::vector<Chunk>> divideCrowds(std::vector<Chunk> chunks, std::uint64_t most, const Grid& grid,
                                          const ChunkOptions& options, Workspace& workspace,
                                          ProgressMeter& progress, const std::stop_token& stop);

}  // namespace scancast
