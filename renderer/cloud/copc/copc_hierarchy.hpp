// The voxels of a COPC file that have points, read page by page and held against the file: each once, each with its parents, each
// chunk within the file. All pages are read: 32 bytes a voxel, of some tens of thousands of points each. Any thread; waits for
// the reader. Pipeline: layout → **hierarchy** → additive tree.
#pragma once

#include <vector>

#include "files/random_reader.hpp"
#include "renderer/cloud/copc/copc_layout.hpp"

namespace scancast {

struct CopcVoxel {
    VoxelKey key;
    std::uint64_t offset = 0;  ///< of its chunk
    std::uint32_t bytes = 0;
    std::uint32_t points = 0;  ///< its own; 0: it has none, and voxels below it have
    std::uint64_t below = 0;   ///< points of it and of everything below it; > 0
};

struct CopcHierarchy {
    std::vector<CopcVoxel> voxels;  ///< by level, then by place; the root first
    std::uint64_t points = 0;
    std::uint64_t digest = 0;  ///< XXH3, 64 bits, of what it says

    /// Index of a voxel; noVoxel where there is none with points.
    std::uint32_t find(const VoxelKey& key) const;
};
inline constexpr std::uint32_t noVoxel = 0xffffffff;

struct CopcLimits {
    std::uint64_t entries = 4 << 20;  ///< 128 MB of them
    std::uint64_t pages = 1 << 16;
    std::uint32_t points = 1 << 20;  ///< of one voxel; of others' programs none has more than some 100,000
    std::uint32_t chunkBytes = 64 << 20;
};

/// Errors without the file's name: Malformed, Truncated, Empty (no voxel has points); ResourceLimit, with the way out; the reader's.
Expected<CopcHierarchy> readCopcHierarchy(const RandomReader& reader, const CopcInfo& info,
                                          const CopcLimits& limits = {});

}  // namespace scancast
