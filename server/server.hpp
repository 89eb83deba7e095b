// The server as one object: catalog, scheduler, API and listener, wired together; what `serve` runs and what
// the integration tests talk to.
//
// Owned by whoever runs it. *Thread safety*: every function may be called from any thread, except
// destruction.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/residency/block_cache.hpp"
#include "server/base/metrics.hpp"
#include "server/catalog/catalog.hpp"
#include "server/catalog/cloud_admin.hpp"
#include "server/catalog/kept_clouds.hpp"
#include "server/net/listen_address.hpp"
#include "server/net/net_context.hpp"
#include "server/net/tls/tls.hpp"
#include "server/price/admission.hpp"
#include "server/scheduler/scheduler.hpp"

namespace scancast {

struct ServerOptions {
    std::string host = "127.0.0.1";
    std::uint16_t port = 8080;                 ///< 0 = any free one
    std::optional<ListenAddress> adminListen;  ///< for probes, beside that; empty = nowhere
    std::vector<std::string> allowedOrigins, allowedHosts;
    TrustedProxies proxies;
    AccessTokens tokens;
    TlsFiles tls;
    std::uint64_t hstsSeconds = 31'536'000;  ///< of Strict-Transport-Security, where there is TLS; 0 = none
    int netThreads = 2;
    NetLimits limits;
    SchedulerOptions scheduler;
    Rates rates = shippedRates();  ///< what pictures cost
    CostLimits costs;              ///< and may
    RequestLogOptions requestLog{};
    std::shared_ptr<BlockCache> cache;    ///< that the clouds' blocks live in, if any do
    std::shared_ptr<KeptClouds> kept;     ///< in which scans are kept, if any are; for /metrics
    std::shared_ptr<RemoteFiles> remote;  ///< that clouds behind URLs are read by; for /metrics
    std::function<RanksStats()> ranks;    ///< that draw, if any do; for /metrics
    bool guestsMayExport = false;         ///< get points, not pictures alone
    std::filesystem::path dataRoot;       ///< whose files administrators may add; empty = none
    std::size_t maxClouds = 256;          ///< at most in the catalog, by administrators
};

class ScancastServer {
  public:
    /// Listens when it returns; the device is being opened then. Errors: those of openTls() and
    /// Listener::create().
    static Expected<std::unique_ptr<ScancastServer>> create(const ServerOptions& options,
                                                            OpenPainter openPainter);
    /// shutDown(), then ends whatever is left.
    virtual ~ScancastServer() = default;

    virtual Catalog& catalog() = 0;
    virtual CloudAdmin& admin() = 0;
    virtual Scheduler& scheduler() = 0;
    virtual Metrics& metrics() = 0;
    /// A live cloud has changed: whoever looks at it sees the new one. Returns at once.
    virtual void cloudsChanged() = 0;
    virtual std::uint16_t port() const = 0;
    /// Of --admin-listen; 0 = nowhere.
    virtual std::uint16_t adminPort() const = 0;
    /// Other tokens, from now on: requests with those that are not among them are refused, and streams that began with
    /// one end. Returns at once.
    virtual void replaceTokens(const AccessTokens& tokens) = 0;
    /// To open in a browser: "http://127.0.0.1:8080/".
    virtual std::string url() const = 0;
    virtual std::size_t connections() const = 0;
    /// What new connections are shown; empty = they come in the clear.
    virtual std::shared_ptr<const ServerTls> tls() const = 0;
    /// Connections that come from now on are shown this; those that are there go on. Only of a server that speaks TLS.
    virtual void replaceTls(ServerTls tls) = 0;
    /// For how long the render thread, or all network threads, have not come back from what they are at; 0 when they
    /// wait for work. Asks the network threads for a sign, so the answer is of use when this is called again and
    /// again. Never waits; from one thread.
    virtual std::chrono::milliseconds silence() = 0;
    /// Before the end, where there are other servers: /readyz says 503, nobody gets a new stream, and the client of each is
    /// told when to go to another one, by `within` at the latest. Whoever is there is drawn for. Returns at once.
    virtual void moveClients(std::chrono::milliseconds within) = 0;
    /// Streams that are open.
    virtual std::size_t sessions() const = 0;
    /// First step of the end: every stream is told, nobody gets a new one, /readyz says 503; snapshots that
    /// wait are still drawn and answered. Returns at once.
    virtual void drain() = 0;
    /// After drain(): whether no stream and no picture is left.
    virtual bool drained() const = 0;
    /// Second step: accepts nothing more, tells every client, cancels every picture. Returns at once.
    virtual void shutDown() = 0;
    /// Whether all clients had left before the time was up.
    virtual bool waitForClients(std::chrono::milliseconds patience) = 0;
};

/// This program's version: "0.1.0".
std::string_view scancastVersion();

}  // namespace scancast
