// Many workers, results in order, bounded: jobs 0, 1, 2 … are worked on beside each other, and what they give is taken as if they had
// been worked on one after the other. Jobs are handed out in their order, so the one whose turn it is always has a worker, and nobody
// waits for ever; a worker that is ahead holds a few pieces and then waits. Owned by one thread, on which pieces are taken.
// Place: an importer's decoders → **in order** → its point stream.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

using Piece = std::vector<std::byte>;

/// Hands a piece of a job over; waits while there is no room for it. False: nobody wants any more, the job may end.
using GivePiece = std::function<bool(Piece)>;

/// What a worker does: jobs, one after the other, on one thread. Errors, and what it throws, end everything when their turn has come.
using JobWorker = std::function<Expected<void>(std::size_t job, const GivePiece& give)>;

/// Takes a piece, on the caller's thread. False: that was enough.
using TakePiece = std::function<Expected<bool>(std::size_t job, Piece piece)>;

struct InOrderLimits {
    std::size_t threads = 1;  ///< at least one
    std::size_t waiting = 2;  ///< pieces of a job that may wait to be taken
};

/// Jobs `first` … `end` - 1. `makeWorker` is called once on each thread. Errors: the first in the order of the jobs, or `take`'s.
Expected<void> runInOrder(std::size_t first, std::size_t end, InOrderLimits limits,
                          const std::function<JobWorker()>& makeWorker, const TakePiece& take);

/// Threads that an importer should have for so many jobs: the machine's cores, 16 at most.
std::size_t importerThreads(std::size_t jobs, std::size_t cores);

}  // namespace scancast
