// What connections share: limits, the routes, and the register of who is connected, so that a shutdown
// reaches all.
//
// Owned by the server, which outlives every connection. *Thread safety*: every function may be called from
// any thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "server/base/metrics.hpp"
#include "server/catalog/catalog.hpp"
#include "server/net/api/api.hpp"
#include "server/net/write_watch.hpp"
#include "server/scheduler/scheduler.hpp"
#include "server/stream/resume_store.hpp"
#include "server/stream/session_register.hpp"

namespace boost::asio::ssl {
class context;
}

namespace scancast {

struct NetLimits {
    std::size_t maxConnections = 512;          ///< beyond, a connection is closed at once
    std::size_t maxSessions = 64;              ///< streams; beyond, 1013
    std::uint64_t maxPixels = 64'000'000;      ///< of a picture
    std::uint32_t maxHeaderBytes = 16 * 1024;  ///< of a request
    std::uint64_t maxBodyBytes = 64 * 1024;    ///< of a request that brings JSON
    std::size_t maxHelloBytes = 4 * 1024;      ///< of a stream's messages before its hello is accepted
    std::size_t maxQueuedTexts = 64;           ///< that a stream's client does not read; beyond, 1008
    std::chrono::milliseconds requestTimeout{
        15000};            ///< for a whole request head, and for the pause between two
    ReadRate leastRate{};  ///< at which a client must read what it is sent
    std::chrono::milliseconds writeTimeout{
        30000};  ///< where the system does not tell how fast that is: for an answer,
                 ///< plus a second for every 64 KiB
    std::chrono::milliseconds helloTimeout{10000};
    std::chrono::milliseconds quiet{150};          ///< without a new view before the final still
    std::chrono::milliseconds idleTimeout{40000};  ///< of a stream; a ping is sent at half of it
    std::chrono::milliseconds closeTimeout{5000};  ///< for a closing handshake
};

/// What a connection takes with its buffers and, where it has one, its session: as measured with a thousand of them.
inline constexpr std::uint64_t bytesOfConnection = 32 * 1024;

/// Anything that is connected and can be asked to leave.
class Connection {
  public:
    virtual ~Connection() = default;
    /// Says goodbye and closes; posts, returns at once.
    virtual void shutDown() = 0;
    /// Ends what would never end by itself; posts, returns at once.
    virtual void sayGoodbye() {}
};

class ConnectionRegister {
  public:
    /// False, and nothing is registered, when `limit` connections are there or everything shuts down.
    bool add(const std::shared_ptr<Connection>& connection, std::size_t limit);
    void remove(const Connection* connection);
    void shutDownAll();
    /// To everybody who is connected now.
    void sayGoodbye() const;
    std::size_t size() const;
    bool shuttingDown() const;

  private:
    std::vector<std::weak_ptr<Connection>> allLocked() const;

    mutable std::mutex mutex_;
    std::unordered_map<const Connection*, std::weak_ptr<Connection>> connections_;
    bool shuttingDown_ = false;
};

struct NetContext {
    NetLimits limits;
    const Api& api;
    const Catalog& catalog;
    Scheduler& scheduler;
    Metrics& metrics;
    SessionRegister& sessionRegister;
    TransientMemory memory{};
    std::shared_ptr<boost::asio::ssl::context> tls{};  ///< empty = in the clear
    ConnectionRegister connections{};
    std::atomic<std::size_t> sessions{0};
    ResumeStore resumable{};
};

}  // namespace scancast
