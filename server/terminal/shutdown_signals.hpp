// SIGINT and SIGTERM as a count that can be waited for, and those that ask a server to begin anew as another.
// One per process, on the main thread; the handlers only count and write to a pipe. Children do not inherit
// them (a handler does not survive exec).
#pragma once

#include <chrono>

namespace scancast {

class ShutdownSignals {
  public:
    enum class Hangup {
        Ends,  ///< SIGHUP is one of wait()'s: the terminal is gone. Where it is ignored already (nohup), it
               ///< stays so
        Reloads  ///< SIGHUP is counted by reloads(); SIGUSR1 and SIGUSR2, which would end the process otherwise, by
                 ///< others(): they are sent by who takes it for another program
    };

    explicit ShutdownSignals(Hangup hangup);
    ~ShutdownSignals();
    ShutdownSignals(const ShutdownSignals&) = delete;
    ShutdownSignals& operator=(const ShutdownSignals&) = delete;

    /// Signals to end so far. Returns early when any comes.
    int wait(std::chrono::milliseconds patience);
    /// Signals to begin anew so far.
    int reloads() const;
    /// Signals so far that mean nothing here.
    int others() const;
};

}  // namespace scancast
