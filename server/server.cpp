#include <utility>  // before Asio: Boost 1.74 forgets it

#include "server/server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <thread>
#include <tuple>

#include "server/base/faults.hpp"
#include "server/net/api/api.hpp"
#include "server/net/listener.hpp"

namespace scancast {
namespace {

namespace asio = boost::asio;

ApiOptions apiOptions(const ServerOptions& options) {
    return {std::string(scancastVersion()),
            options.limits.maxPixels,
            {options.host, options.allowedOrigins, options.allowedHosts},
            options.cache,
            options.kept,
            options.remote,
            options.tokens,
            options.rates,
            options.costs,
            options.scheduler.memory,
            options.adminListen ? options.adminListen->host : std::string(),
            options.tls.given() ? strictTransport(options.hstsSeconds) : std::string(),
            options.ranks,
            {.guestsMayExport = options.guestsMayExport}};
}

class RunningServer final : public ScancastServer {
  public:
    RunningServer(const ServerOptions& options, OpenPainter openPainter)
        : options_(options),
          metrics_(scancastVersion()),
          scheduler_(std::move(openPainter), options.scheduler, metrics_),
          admin_(catalog_, options.dataRoot, options.maxClouds),
          api_(apiOptions(options), catalog_, admin_, sessions_, scheduler_, metrics_),
          requestLog_(options.requestLog, metrics_),
          context_{options.limits, api_,      catalog_,    scheduler_,
                   metrics_,       sessions_, requestLog_, options.scheduler.memory},
          io_(std::max(1, options.netThreads)),
          work_(asio::make_work_guard(io_)),
          logTimer_(io_) {
        catalog_.setCache(options.cache);
    }

    ~RunningServer() override {
        shutDown();
        work_.reset();
        io_.stop();
        for (std::thread& thread : threads_) thread.join();
        // Pictures post into io_, so the scheduler's threads end before it; connections that are left live in
        // io_'s handlers and end with it, while everything that they refer to (declared before it) still
        // exists.
        scheduler_.wait();
        api_.stop();
    }

    Expected<void> start() {
        if (options_.tls.given()) {
            auto tls = openTls(options_.tls);
            if (!tls) return passOn(std::move(tls));
            replaceTls(std::move(*tls));
        }
        context_.proxies = options_.proxies;
        setSessionKeys(options_.tokens);
        auto listener = Listener::create(io_, {options_.host, options_.port}, context_, Entrance::Public);
        if (!listener) return passOn(std::move(listener));
        listener_ = std::move(*listener);
        if (options_.adminListen) {
            auto probes = Listener::create(io_, *options_.adminListen, context_, Entrance::Probes);
            if (!probes) return passOn(std::move(probes));
            probeListener_ = std::move(*probes);
            probeListener_->run();
        }
        listener_->run();
        keepLog();
        for (int i = 0; i < std::max(1, options_.netThreads); ++i) {
            threads_.emplace_back([this] { runNetwork(); });
        }
        return {};
    }

    Catalog& catalog() override { return catalog_; }
    CloudAdmin& admin() override { return admin_; }
    Scheduler& scheduler() override { return scheduler_; }
    Metrics& metrics() override { return metrics_; }
    void cloudsChanged() override { sessions_.wakeAll(); }
    void replaceTokens(const AccessTokens& tokens) override {
        api_.access().replace(tokens);
        setSessionKeys(tokens);
        sessions_.wakeAll();
    }
    std::uint16_t port() const override { return listener_->port(); }
    std::uint16_t adminPort() const override { return probeListener_ ? probeListener_->port() : 0; }
    std::size_t connections() const override { return context_.connections.size() + context_.probes.size(); }

    std::string url() const override {
        const std::string& host = options_.host;
        const bool everywhere = host == "0.0.0.0" || host == "::";
        const bool v6 = host.find(':') != std::string::npos;
        const std::string shown = everywhere ? "localhost" : v6 ? "[" + host + "]" : host;
        return fmt::format("{}://{}:{}/", context_.tls.get() ? "https" : "http", shown, port());
    }

    std::shared_ptr<const ServerTls> tls() const override { return context_.tls.get(); }

    void replaceTls(ServerTls tls) override {
        metrics_.setCertificateExpiry(tls.expires);
        context_.tls.replace(std::move(tls));
    }

    std::chrono::milliseconds silence() override {
        using Clock = std::chrono::steady_clock;
        const Clock::duration now = Clock::now().time_since_epoch();
        const Clock::duration asked = networkAsked_;
        if (asked == Clock::duration{}) {
            networkAsked_ = now;
            const auto posted = contained("Asking the network threads", [this] {
                asio::post(io_, [this] { networkAsked_ = Clock::duration{}; });
            });
            if (!posted) networkAsked_ = Clock::duration{};  // nobody was asked
            return scheduler_.silence();
        }
        return std::max(scheduler_.silence(),
                        std::chrono::duration_cast<std::chrono::milliseconds>(now - asked));
    }

    void moveClients(std::chrono::milliseconds within) override {
        metrics_.setDraining();
        context_.leavesAt = (std::chrono::steady_clock::now() + within).time_since_epoch();
        api_.leave();
        sessions_.moveAll(within);  // who comes in now finds it out himself
    }

    std::size_t sessions() const override { return context_.sessions; }

    void drain() override {
        metrics_.setDraining();
        scheduler_.drain();
        context_.connections.sayGoodbye();
    }

    bool drained() const override { return context_.sessions == 0 && scheduler_.idle(); }

    void shutDown() override {
        std::ignore = contained("Shutting down", [this] {
            if (listener_) listener_->close();
            if (probeListener_) probeListener_->close();
        });
        std::ignore = contained("Shutting down", [this] { context_.connections.shutDownAll(); });
        std::ignore = contained("Shutting down", [this] { context_.probes.shutDownAll(); });
        scheduler_.stop();
    }

    bool waitForClients(std::chrono::milliseconds patience) override {
        const auto end = std::chrono::steady_clock::now() + patience;
        while (connections() > 0) {
            if (std::chrono::steady_clock::now() >= end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return true;
    }

  private:
    void setSessionKeys(const AccessTokens& tokens) {
        std::vector<std::string> keys;
        for (const NamedToken& key : tokens.sessionKeys) keys.push_back(key.token);
        context_.resumable.setKeys(std::move(keys));
    }

    // What repeats is told of when its time is over, also when nobody asks for anything any more.
    void keepLog() {
        constexpr std::chrono::seconds interval{1};
        logTimer_.expires_after(interval);
        logTimer_.async_wait([this](boost::system::error_code ec) {
            if (ec) return;
            requestLog_.passTime(std::chrono::steady_clock::now());
            keepLog();
        });
    }

    // What a handler throws ends with that handler, and run() may be entered again.
    void runNetwork() {
        while (!contained("A network thread", [this] { io_.run(); })) {
        }
    }

    const ServerOptions options_;
    Metrics metrics_;
    Catalog catalog_;
    Scheduler scheduler_;
    CloudAdmin admin_;
    SessionRegister sessions_;
    Api api_;
    RequestLog requestLog_;
    NetContext context_;
    std::atomic<std::chrono::steady_clock::duration> networkAsked_{
        {}};  // for a sign, and since; 0 = answered
    asio::io_context io_;
    asio::executor_work_guard<asio::io_context::executor_type> work_;
    asio::steady_timer logTimer_;  ///< one wait at a time, each begun by the handler of the one before
    std::shared_ptr<Listener> listener_, probeListener_;
    std::vector<std::thread> threads_;
};

}  // namespace

Expected<std::unique_ptr<ScancastServer>> ScancastServer::create(const ServerOptions& options,
                                                                 OpenPainter openPainter) {
    auto server = std::make_unique<RunningServer>(options, std::move(openPainter));
    if (auto ok = server->start(); !ok) return passOn(ok);
    return server;
}

std::string_view scancastVersion() {
    return SCANCAST_VERSION;
}

}  // namespace scancast
