// Points go to the owners of their chunks, and as halos to those of the chunks around: in rounds, so that no rank holds more than a
// bounded amount on its way. Pipeline: staged portions → **rounds** → chunks of this rank.
#pragma once

#include "ranks/ingest/chunk_owners.hpp"
#include "ranks/mpi/communicator.hpp"
#include "renderer/cloud/build/chunks/chunk_sorting.hpp"

namespace scancast {

/// All ranks call it, each with its own portions, which are used up. The rank's chunks, in the order of the layout; they have no place in
/// the tree yet. Uses the caller's TBB arena. Errors: the portions' and the workspace's, of any rank; Cancelled.
Expected<std::vector<Chunk>> pointsToOwners(PointPortions& portions, const ChunkLayout& layout,
                                            const ChunkOwners& owners, std::size_t rowBytes,
                                            Workspace& workspace, const Communicator& ranks,
                                            ProgressMeter& progress, const std::stop_token& stop);

}  // namespace scancast
