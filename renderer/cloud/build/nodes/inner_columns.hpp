// What inner nodes' samples have of the kept columns: each the values of one point of the scan, the one that is nearest - so that
// what several columns say together is said by a point that there is. Pipeline: octree in a file → **inner columns** → facts,
// indices. Called once a cloud file, when all other blocks are in it, by the process that finishes it; so ranks' files are one
// process' bytes.
#pragma once

#include <stop_token>

#include "renderer/cloud/build/octree_builder.hpp"

namespace scancast {

/// A cloud file has no more companions than 64, and some are others'.
inline constexpr std::size_t mostInnerColumns = 48;

/// Of how the work is done; what is found does not depend on it.
struct InnerColumnsRoom {
    int threads = 0;  ///< 0: all of the machine's
    std::uint64_t memory =
        0;  ///< bytes that nodes which are worked on at once may take; one node is at any rate
};

/// Companions of the facts (innerPlane()), their blocks, and their places among the octree's. Those columns are left out that stand for
/// what samples have already (`ingest --exact`), and those whose name another has before them. Nothing where a leaf is the root.
/// Reads everything back once, a level at a time; reports the stage "columns" (nodes). Errors: the file's; Cancelled.
Expected<void> addInnerColumns(CloudFacts& facts, BuiltOctree& octree, BlockSink& file,
                               const InnerColumnsRoom& room, const ProgressSink& progress,
                               const std::stop_token& stop);

}  // namespace scancast
