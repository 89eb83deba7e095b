// What connections share: limits, the routes, and the registers of who is connected.
//
// Owned by the server, which outlives every connection. *Thread safety*: every function may be called from
// any thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "server/base/metrics.hpp"
#include "server/catalog/catalog.hpp"
#include "server/net/api/api.hpp"
#include "server/net/clients/connection_register.hpp"
#include "server/net/clients/trusted_proxies.hpp"
#include "server/net/log/request_log.hpp"
#include "server/net/tls/current_tls.hpp"
#include "server/net/write_watch.hpp"
#include "server/scheduler/scheduler.hpp"
#include "server/scheduler/video_places.hpp"
#include "server/stream/resume_store.hpp"
#include "server/stream/session_register.hpp"

namespace scancast {

struct NetLimits {
    std::size_t maxConnections = 512;  ///< beyond, idle ones go, or who comes gets 503
    std::size_t maxConnectionsPerAddress =
        0;                           ///< beyond, 429; 0 = a quarter of all, and this machine not limited
    std::size_t maxSessions = 64;    ///< streams; beyond, 1013
    std::size_t videoSessions = 16;  ///< of them, whose moving frames may be video; beyond, JPEG
    std::uint64_t maxPixels = 64'000'000;      ///< of a picture
    std::uint32_t maxHeaderBytes = 16 * 1024;  ///< of a request
    std::uint64_t maxBodyBytes = 64 * 1024;    ///< of a request that brings JSON
    std::size_t maxHelloBytes =
        32 * 1024;  ///< of a stream's messages before its hello is accepted; it may bring a whole view
    std::size_t maxQueuedTexts = 64;  ///< that a stream's client does not read; beyond, 1008
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

/// What a connection takes at the most with its buffers or, where it has one, its session. Measured: 5 kB of each of a
/// thousand HTTP connections that have asked for something small, 27 kB of each of five hundred sessions.
inline constexpr std::uint64_t bytesOfConnection = 32 * 1024;

/// How NetLimits are meant for the public address and for the one of probes.
constexpr ConnectionLimits publicLimits(const NetLimits& limits) {
    const std::size_t share = std::max<std::size_t>(1, limits.maxConnections / 4);
    return {limits.maxConnections,
            limits.maxConnectionsPerAddress > 0 ? limits.maxConnectionsPerAddress : share};
}
/// Few, and all of them idle as soon as their answer is made: who comes is always let in.
inline constexpr ConnectionLimits probeLimits{32, 32};

struct NetContext {
    NetLimits limits;
    const Api& api;
    const Catalog& catalog;
    Scheduler& scheduler;
    Metrics& metrics;
    SessionRegister& sessionRegister;
    RequestLog& requestLog;
    TransientMemory memory{};
    VideoPlaces video{limits.videoSessions, memory};
    CurrentTls tls{};
    TrustedProxies proxies{};
    ConnectionRegister connections{publicLimits(limits), &metrics};
    ConnectionRegister probes{probeLimits};
    std::atomic<std::size_t> refusedLingering{0};  ///< refused_connection.cpp
    std::atomic<std::size_t> sessions{0};
    ResumeStore resumable{};
    std::atomic<std::chrono::steady_clock::duration> leavesAt{{}};  ///< 0: it stays

    /// How long the server will be there, when it takes nobody any more.
    std::optional<std::chrono::milliseconds> leavesIn() const {
        const std::chrono::steady_clock::duration at = leavesAt;
        if (at == std::chrono::steady_clock::duration{}) return std::nullopt;
        const auto left = at - std::chrono::steady_clock::now().time_since_epoch();
        return std::max(std::chrono::milliseconds(0),
                        std::chrono::duration_cast<std::chrono::milliseconds>(left));
    }

    ConnectionRegister& registerOf(Entrance entrance) {
        return entrance == Entrance::Public ? connections : probes;
    }
    /// Probes come in the clear: who sends them rarely knows certificates.
    std::shared_ptr<boost::asio::ssl::context> tlsOf(Entrance entrance) const {
        const auto now = entrance == Entrance::Public ? tls.get() : nullptr;
        return now ? now->context : nullptr;
    }
    /// Whom a connection of this peer is counted for before it has asked for anything. Not limited are proxies, and,
    /// unless a limit was given, this machine: all who forward a port come from there.
    CountedClient peerOf(const std::optional<IpAddress>& address) const {
        if (!address) return {};
        const bool exempt =
            proxies.trusts(*address) || (limits.maxConnectionsPerAddress == 0 && address->isLoopback());
        return {address->client(), !exempt};
    }
};

}  // namespace scancast
