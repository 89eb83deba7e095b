// A page of an EPT hierarchy: a JSON file of the nodes of an octree and how many points each has, which refers to others. Pages are
// taken in, never believed: every key has its place, no page is known twice, and how many nodes there may be is bounded. Who reads the
// files is somebody else: the importer of a folder, or whoever shows EPT as it is. Pure functions on bytes.
// Pipeline: description → **pages** → tiles → points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

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
    std::uint64_t points = 0;
};

/// What the pages that have been taken in say.
struct EptPages {
    std::deque<EptNode> nodes;   ///< in the order in which they came; perhaps without points, perhaps twice
    std::deque<VoxelKey> ahead;  ///< pages that have been referred to; whoever reads one takes it off
    std::set<VoxelKey> known;    ///< all pages that have been
};

/// The file that a page is: "ept-hierarchy/0-0-0-0.json".
std::string eptPageName(const VoxelKey& root);

/// Adds a page's nodes. Malformed, naming the page's file.
Expected<void> parseEptPage(std::span<const std::byte> bytes, const VoxelKey& root, EptPages& pages);

}  // namespace scancast::import_octree
