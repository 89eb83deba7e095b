// A rank that fails tells the others at once, while they work: they need not read for an hour before they hear of it. Owned by a command
// beside its communicator; a thread of its own listens. Place: a rank's error → **alarm** → everybody's stop token.
#pragma once

#include <atomic>
#include <stop_token>
#include <thread>

#include "ranks/mpi/communicator.hpp"

namespace scancast {

class Alarm {
  public:
    /// `work` is asked to stop when another rank rings. All ranks call it.
    Alarm(const Communicator& of, std::stop_source work);
    ~Alarm();
    Alarm(const Alarm&) = delete;
    Alarm& operator=(const Alarm&) = delete;

    /// The first time, the others hear of it. What went wrong is told by agree(), later.
    void ring();

  private:
    void listen(const std::stop_token& done);

    MPI_Comm comm_ = MPI_COMM_NULL;
    const Communicator& of_;
    std::stop_source work_;
    bool hasRung_ = false;
    std::jthread listener_;
};

}  // namespace scancast
