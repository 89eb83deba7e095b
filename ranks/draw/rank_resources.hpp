// How much of its machine a rank takes where nobody says so. Pure but for what it asks the system; any thread.
#pragma once

#include <cstdint>

#include "ranks/mpi/session.hpp"

namespace scancast {

/// Before MPI starts: who waits for another rank leaves the core to whoever needs it, unless the environment says otherwise. (Of
/// Open MPI; it does so by itself only where it knows of more ranks than cores.)
void yieldWhileWaiting();

/// Of a machine's cores the ranks on it have as many each, at least one; where mpirun has bound a rank to some, those.
int threadsOfRank(const MpiSession& mpi);
/// Bytes: of half of the machine's memory.
std::uint64_t memoryOfRank(const MpiSession& mpi);

/// All ranks call it: the least of their limits is everybody's, as rank 0 reckons with as much on each. Errors: where one rank has no
/// number, its error.
Expected<std::uint64_t> leastOfRanks(const Communicator& ranks, const Expected<std::uint64_t>& mine);

}  // namespace scancast
