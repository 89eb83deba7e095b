// Everybody's blocks become one cloud file, in the order in which one process would have written them. Rank 0 writes, the others send,
// front to back. Pipeline: shelves → **gathered** → cloud file.
#pragma once

#include <span>

#include "ranks/ingest/block_shelf.hpp"
#include "ranks/ingest/shared_tree.hpp"
#include "renderer/cloud/file/cloud_file_writer.hpp"

namespace scancast {

/// Where a shelf's parts end: planes of leaves that waited for their sides, all else of leaves, inner nodes.
struct ShelfParts {
    std::uint64_t held = 0, leaves = 0;
};

/// All ranks call it; `file` is rank 0's, null elsewhere. `inner`: of the whole tree, level after level. At rank 0 all places of the tree
/// are then those in the file, and cones and hashes of inner nodes are known. Errors: the file's and the shelves'.
Expected<void> gatherFile(NumberedTree& tree, std::span<BuildNode* const> inner, const BlockShelf& shelf,
                          const ShelfParts& parts, CloudFileWriter* file, const Communicator& ranks);

}  // namespace scancast
