// An ingest by several ranks: what renderer/cloud/build/ingest.hpp does in one process, each step shared, and the same bytes in the end
// (docs/decisions/024-ranks-share-the-build.md). Called on the command's thread by all ranks; uses a TBB arena of its own.
//
//   read       each its share of the points            → joined: extent, ranges, notes
//   count      each its points                         → joined: counting grid, chunks and their owners
//   sort       points go to the owners of their chunks, and to those around as halos
//   build      each the subtrees of its chunks         → joined: sides; the nodes above, by rank 0
//   finish     each its inner nodes; samples of neighbours are fetched from their owners
//   write      rank 0 writes everybody's blocks into one file
#pragma once

#include "ranks/mpi/alarm.hpp"
#include "ranks/mpi/communicator.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/build/workspace.hpp"

namespace scancast {

struct RankRoom {
    const Communicator& ranks;
    Alarm& alarm;
    int onThisMachine = 1;  ///< ranks that share its memory, cores and disk
    /// No more waits in memory than this, whatever the limit: tests have points on disk without a gigabyte of them.
    std::uint64_t mostWaiting = Workspace::unlimited;
    /// Nor is more sent at once: tests have many rounds of few points.
    std::uint64_t mostInRound = Workspace::unlimited;
};

/// Threads and memory limit of this rank, where the options leave them open: its part of the machine's.
IngestOptions withOwnPart(IngestOptions options, int onThisMachine);

/// `sources`: the same on all ranks, opened for their headers. `options.memoryLimit` is this rank's. The report is complete at rank 0;
/// `progress` is of this rank's own share. The output's name is locked from the start, by rank 0. Errors: ingest()'s, the same on all
/// ranks, whoever failed; and no file is left: when `stop` is requested, the unfinished one loses its name at once, whatever rank 0 is
/// doing then.
Expected<IngestReport> ingestTogether(std::vector<std::unique_ptr<PointSource>> sources,
                                      const IngestOptions& options, const RankRoom& room,
                                      const ProgressSink& progress, std::stop_token stop);

}  // namespace scancast
