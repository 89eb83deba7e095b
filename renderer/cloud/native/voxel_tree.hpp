// The octree of a scan that is shown as it is: voxels, each with points of its own that *add* to those of the voxels above. Whatever the
// format that it was read from - pages of COPC, of EPT -, every voxel is there once and has its parents. Plain values, pure functions.
// Pipeline: hierarchy → **voxel tree** → additive tree.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// The root's voxel, file coordinates.
struct VoxelCube {
    glm::dvec3 center{0};
    double halfSize = 0;  ///< of its side; > 0
};

/// A voxel of the octree: at `level`, the cube is cut into 2^level parts on each axis.
struct VoxelKey {
    std::int32_t level = 0;
    std::array<std::int32_t, 3> at{};
    auto operator<=>(const VoxelKey&) const = default;

    VoxelKey parent() const { return {level - 1, {at[0] >> 1, at[1] >> 1, at[2] >> 1}}; }
    /// Bit a of `octant`: the upper half on axis a.
    VoxelKey child(int octant) const {
        return {level + 1,
                {at[0] * 2 + (octant & 1), at[1] * 2 + (octant >> 1 & 1), at[2] * 2 + (octant >> 2 & 1)}};
    }
};
/// "2-0-3-1", as every format with such octrees writes it.
std::string text(const VoxelKey& key);

/// Deeper ones are refused: the coordinates of a level have as many bits, and nodes count levels in 8.
inline constexpr std::int32_t deepestVoxel = 30;

struct Voxel {
    VoxelKey key;
    std::uint64_t offset = 0;  ///< of its chunk, where all are in one file; 0 where each is a file
    std::uint32_t bytes = 0;
    std::uint32_t points = 0;  ///< its own; 0: it has none, and voxels below it have
    std::uint64_t below = 0;   ///< points of it and of everything below it; > 0
};

inline constexpr std::uint32_t noVoxel = 0xffffffff;

struct VoxelTree {
    std::vector<Voxel> voxels;  ///< by level, then by place; the root first
    std::uint64_t points = 0;
    std::uint64_t digest = 0;  ///< XXH3, 64 bits, of what it says

    /// Index of a voxel; noVoxel where there is none with points.
    std::uint32_t find(const VoxelKey& key) const;
};

/// What is too much to be shown as it is.
struct VoxelLimits {
    std::uint64_t entries = 4 << 20;  ///< 128 MB of them
    std::uint64_t pages = 1 << 16;
    std::uint32_t points = 1 << 20;  ///< of one voxel; of others' programs none has more than some 100,000
    std::uint32_t chunkBytes = 64 << 20;
};
/// Ends sentences on what is not shown as it is.
inline constexpr const char* ingestInstead = "; ingest it, and serve what comes of that";

/// Sorts them and counts what lies below; `below` of each is what it has itself. Voxels without points that have none below are left out.
/// Errors without the file's name: Malformed, Empty (no voxel has points).
Expected<VoxelTree> voxelTreeOf(std::vector<Voxel> voxels);

}  // namespace scancast
