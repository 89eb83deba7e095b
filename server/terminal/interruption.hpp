// Ctrl-C while a command works. Owner: a command, for as long as it works. Threads: one of its own, which watches.
#pragma once

#include <stop_token>
#include <thread>

#include "server/terminal/shutdown_signals.hpp"

namespace scancast {

/// While it lives, Ctrl-C, or the end of its terminal, asks the work to stop; a second one ends the process
/// as it is (temporary files are unnamed and the unfinished file is marked as such, so nothing misleading is
/// left even then).
class Interruption {
  public:
    Interruption();
    std::stop_token token() const { return stop_.get_token(); }

  private:
    void watch(const std::stop_token& done);

    ShutdownSignals signals_{ShutdownSignals::Hangup::Ends};
    std::stop_source stop_;
    std::jthread watcher_;
};

}  // namespace scancast
