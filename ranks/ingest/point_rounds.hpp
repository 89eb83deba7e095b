// Points go to the owners of their chunks, and as halos to those of the chunks around: in rounds, so that no rank holds more than a
// bounded amount on its way. Pipeline: staged portions → **rounds** → chunks of this rank.
#pragma once

#include "ranks/ingest/chunk_owners.hpp"
#include "ranks/mpi/alarm.hpp"
#include "ranks/mpi/communicator.hpp"
#include "renderer/cloud/build/chunks/chunk_sorting.hpp"

namespace scancast {

struct RoundRoom {
    const Communicator& ranks;
    Alarm& alarm;
    Workspace& workspace;
    /// The same on all ranks: so much for others waits to be sent, as much is on its way, and as much comes.
    std::uint64_t bytes = 0;
};

/// All ranks call it, each with its own portions, which are used up. The rank's chunks, in the order of the layout; they have no place in
/// the tree yet. Sorts with all threads of the caller's TBB arena; what was sorted is exchanged meanwhile, by a thread of its own. Errors:
/// the portions' and the workspace's, of any rank; Cancelled.
Expected<std::vector<Chunk>> pointsToOwners(PointPortions& portions, const ChunkLayout& layout,
                                            const ChunkOwners& owners, std::size_t rowBytes,
                                            const RoundRoom& room, ProgressMeter& progress,
                                            const std::stop_token& stop);

}  // namespace scancast
