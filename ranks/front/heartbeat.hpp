// All ranks of a job say to each other twice a second that they are there, beside whatever they are at: MPI waits for ever for a machine
// that has vanished without a word. Owned by a rank's command; a thread of its own. Place: draw command → **heartbeat** → communicator.
#pragma once

#include <functional>
#include <thread>

#include "ranks/mpi/communicator.hpp"

namespace scancast {

class Heartbeat {
  public:
    /// All ranks call it; `ranks` is for nothing else and outlives this. `onBeat`: all are there. Where they are not, this ends all
    /// ranks that it reaches.
    Heartbeat(const Communicator& ranks, std::function<void()> onBeat);
    Heartbeat(const Heartbeat&) = delete;
    Heartbeat& operator=(const Heartbeat&) = delete;

  private:
    void beat(const std::stop_token& done);

    const Communicator& ranks_;
    const std::function<void()> onBeat_;
    std::jthread thread_;
};

}  // namespace scancast
