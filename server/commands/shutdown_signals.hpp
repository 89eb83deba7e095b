// SIGINT and SIGTERM as a count that can be waited for. One per process, on the main thread; the handler only
// counts and writes to a pipe. Children do not inherit it (a handler does not survive exec).
#pragma once

#include <chrono>

namespace scancast {

class ShutdownSignals {
  public:
    ShutdownSignals();
    ~ShutdownSignals();
    ShutdownSignals(const ShutdownSignals&) = delete;
    ShutdownSignals& operator=(const ShutdownSignals&) = delete;

    /// Signals so far. Returns early when one comes.
    int wait(std::chrono::milliseconds patience);
};

}  // namespace scancast
