// Everybody's blocks become one cloud file, in the order in which one process would have written them. Rank 0 writes, the others send,
// front to back. Pipeline: shelves → **gathered** → cloud file.
#pragma once

#include <span>
#include <stop_token>

#include "ranks/ingest/block_shelf.hpp"
#include "ranks/ingest/shared_tree.hpp"
#include "ranks/mpi/alarm.hpp"
#include "renderer/cloud/file/cloud_file_writer.hpp"
#include "renderer/cloud/progress.hpp"

namespace scancast {

/// Where a shelf's parts end: planes of leaves that waited for their sides, all else of leaves, inner nodes.
struct ShelfParts {
    std::uint64_t held = 0, leaves = 0;
};

struct GatheringRoom {
    const Communicator& ranks;
    Alarm& alarm;  ///< rung by who cannot go on, so that nobody sends or writes what will be nothing
    const ProgressSink& progress;
    const std::stop_token& stop;
};

/// All ranks call it; `file` is rank 0's, null elsewhere. `inner`: of the whole tree, level after level. At rank 0 all places of the tree
/// are then those in the file, and cones and hashes of inner nodes are known. Reports the stage "writing" (bytes), at rank 0. Errors:
/// the file's and the shelves'; Cancelled.
Expected<void> gatherFile(NumberedTree& tree, std::span<BuildNode* const> inner, const BlockShelf& shelf,
                          const ShelfParts& parts, CloudFileWriter* file, const GatheringRoom& room);

}  // namespace scancast
