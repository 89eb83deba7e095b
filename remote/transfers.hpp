// All requests of a process to object storage: one thread has them under way at once, over connections that are kept (and shared
// by many requests where the server speaks HTTP/2). What fails for want of an answer is tried again, ever later and never at the
// same time as others; each try has an end, so each request has one.
//
// Owned by `RemoteFiles`. *Thread safety*: every function may be called from any thread. Place: pieces → **transfers** → network.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "remote/transfer.hpp"

namespace scancast {

struct TransfersOptions {
    TransferLimits limits{};
    std::chrono::milliseconds firstDelay{
        100};  ///< before the second try; twice as long before each further one
    std::chrono::milliseconds longestDelay{3000};
    long connectionsToHost = 64;
    std::uint32_t seed = 0;  ///< of what is added to delays; 0 = another one each time
};

struct TransfersStats {
    std::uint64_t requests = 0, retries = 0, bytes = 0;  ///< bytes: of parts that came whole
};

class Transfers {
  public:
    /// ResourceLimit where the system has no more threads or memory.
    static Expected<std::shared_ptr<Transfers>> create(const TransfersOptions& options);
    /// stop(), then waits for the thread.
    virtual ~Transfers() = default;

    /// Never waits. After stop(), `done` is called at once, with Stopped.
    virtual void start(PartAsk ask, PartDone done) = 0;
    /// Ends everything with Stopped, soon.
    virtual void stop() = 0;
    virtual TransfersStats stats() const = 0;
};

}  // namespace scancast
