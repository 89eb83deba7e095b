// The nodes of an EPT folder and how many points each has: pages of JSON that refer to each other. Pages are read, never
// believed: every key has its place, no page is read twice, and how many nodes there may be is bounded.
// Pipeline: description → **hierarchy** → tiles → points.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "importers/octree/tree/tree_files.hpp"

namespace scancast::import_octree {

/// A cube of the octree: which one in x, y and z of the 2^depth there are.
struct VoxelKey {
    std::uint32_t depth = 0, x = 0, y = 0, z = 0;
    auto operator<=>(const VoxelKey&) const = default;
};

/// "2-0-3-1": four numbers without leading zeros, of a depth of 31 at most, and within it.
std::optional<VoxelKey> parseVoxelKey(std::string_view text);
std::string text(const VoxelKey& key);
/// Itself included.
bool isWithin(const VoxelKey& key, const VoxelKey& root);

struct EptNode {
    VoxelKey key;
    std::uint64_t points = 0;  ///< at least one
};

/// All nodes that have points, level after level. Errors: those of reading a page, Malformed, ResourceLimit; they name it.
Expected<std::deque<EptNode>> readEptHierarchy(const TreeFiles& files);

}  // namespace scancast::import_octree
