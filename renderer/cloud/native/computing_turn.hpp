// Who computes on a block of a native cloud, of the many threads that wait for what they read.
// *Thread safety*: made and ended on any thread. Place: gathered points → **turn** → samples, surfels.
#pragma once

#include <algorithm>

#include "files/machine.hpp"
#include "threads/monitor.hpp"

namespace scancast {

/// A place among those who compute, as long as it lives: many wait for what they read at once, and drawing needs processors, too.
class ComputingTurn {
  public:
    ComputingTurn() {
        Monitor::Lock lock(monitor());
        monitor().wait(lock, [] { return count() < std::max(1, machineCores() - 1); });
        ++count();
    }
    ~ComputingTurn() {
        const Monitor::Lock lock(monitor());
        --count();
    }
    ComputingTurn(const ComputingTurn&) = delete;
    ComputingTurn& operator=(const ComputingTurn&) = delete;

  private:
    static Monitor& monitor() {
        static Monitor all;
        return all;
    }
    static int& count() {
        static int computing = 0;
        return computing;
    }
};

}  // namespace scancast
