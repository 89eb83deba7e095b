#include "ranks/draw/rank_resources.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <span>

#include "files/machine.hpp"

namespace scancast {

void yieldWhileWaiting() {
    ::setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
}

int threadsOfRank(const MpiSession& mpi) {
    cpu_set_t bound;
    CPU_ZERO(&bound);
    const long online = ::sysconf(_SC_NPROCESSORS_ONLN);
    if (::sched_getaffinity(0, sizeof bound, &bound) == 0) {
        const int mine = CPU_COUNT(&bound);
        if (mine > 0 && mine < online) return std::min(mine, machineCores());
    }
    return std::max(1, machineCores() / mpi.ranksOnThisMachine());
}

std::uint64_t memoryOfRank(const MpiSession& mpi) {
    return machineMemory() / 2 / std::uint64_t(mpi.ranksOnThisMachine());
}

Expected<std::uint64_t> leastOfRanks(const Communicator& ranks, const Expected<std::uint64_t>& mine) {
    const auto agreed = ranks.agree(mine);
    if (!agreed) return agreed;
    std::uint64_t least = *agreed;
    if (auto ok = ranks.min(std::span(&least, 1)); !ok) return passOn(ok);
    return least;
}

}  // namespace scancast
