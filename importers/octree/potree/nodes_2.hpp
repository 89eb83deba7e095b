// The nodes of a Potree 2 octree: hierarchy.bin, a tree of chunks that refer to each other by place. No chunk is read twice,
// and how many nodes there may be is bounded. Pipeline: description → **nodes** → points.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "importers/octree/tree/tree_files.hpp"

namespace scancast::import_octree {

/// Where the points of a node are in octree.bin.
struct PotreeNode {
    std::string name;
    std::uint32_t points = 0;
    std::uint64_t at = 0, bytes = 0;
};

/// All nodes that have bytes. Errors: Malformed, those of reading; they name the byte.
Expected<std::vector<PotreeNode>> readHierarchy2(const TreeFiles& files, std::uint64_t firstChunkBytes);

}  // namespace scancast::import_octree
