// MPI from its start to its end: the first thing that a subcommand of scancast-ranks makes, and the last that goes. Owned by the
// command, on its thread. Place: command line → **session** → communicators.
#pragma once

#include <memory>
#include <stop_token>
#include <string_view>

#include "protocol/error.hpp"
#include "ranks/mpi/communicator.hpp"

namespace scancast {

class MpiSession {
  public:
    /// MPI with as many threads as like to call it. `interrupted`: whoever waits for another rank then gives up after a moment, and
    /// this process ends without a word to MPI. Signals have to be caught before: MPI's threads must not get them. Errors: Unsupported
    /// (an MPI without threads), Internal (it was started before), Io (it did not start).
    static Expected<std::unique_ptr<MpiSession>> start(std::stop_token interrupted);
    /// The end of MPI, or, where somebody gave up waiting or failed alone, nothing.
    ~MpiSession();
    MpiSession(const MpiSession&) = delete;
    MpiSession& operator=(const MpiSession&) = delete;

    /// All ranks.
    Communicator& world() { return *world_; }
    /// Those on this machine: as many share its memory and its cores.
    int ranksOnThisMachine() const { return onThisMachine_; }

    /// For what went wrong where the others do not expect to hear of it: says so and ends all ranks at once.
    [[noreturn]] static void abortAll(std::string_view sentence);

  private:
    MpiSession() = default;

    std::unique_ptr<Communicator> world_;
    int onThisMachine_ = 1;
};

/// Before MPI is started: this process is the one that speaks for all that mpirun started, or it was started alone.
bool isFirstOfMany();

}  // namespace scancast
