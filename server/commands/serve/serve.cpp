// `scancast serve`: opens cloud files, loads scans and serves pictures of them until it is told to stop.
#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/text/plain_text.hpp"
#include "renderer/cloud/import/scan_input.hpp"
#include "server/base/byte_size.hpp"
#include "server/base/faults.hpp"
#include "server/base/log.hpp"
#include "server/base/memory_reserve.hpp"
#include "server/catalog/damage_reports.hpp"
#include "server/commands/command.hpp"
#include "server/commands/config_file.hpp"
#include "server/commands/program_folder.hpp"
#include "server/commands/serve/clouds.hpp"
#include "server/commands/serve/reload.hpp"
#include "server/commands/serve/serve.hpp"
#include "server/commands/serve/upkeep.hpp"
#include "server/commands/serve_options.hpp"
#include "server/commands/service_reports.hpp"
#include "server/net/clients/open_files.hpp"
#include "server/scheduler/video_places.hpp"
#include "server/server.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/shutdown_signals.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

constexpr std::chrono::milliseconds drainPatience{30000};  // a snapshot may take that long
constexpr std::chrono::milliseconds shutdownPatience{5000};

int failure(const Error& error) {
    tell("scancast serve: {}\n", error.message);
    return 1;
}

std::shared_ptr<BlockCache> blockCache(std::uint64_t memoryLimit, std::shared_ptr<DamageReports> damage) {
    BlockCacheOptions options;
    options.memoryLimit = memoryLimit;
    options.onDamaged = [damage = std::move(damage)](const std::shared_ptr<const CloudFile>& file,
                                                     const Error& error) { damage->add(file, error); };
    return BlockCache::create(options);
}

std::shared_ptr<KeptClouds> keptClouds(const ServeOptions& options) {
    if (options.cacheDir.empty()) return nullptr;
    KeptCloudsOptions kept;
    kept.folder = options.cacheDir;
    kept.limit = cacheShares(options).scans;
    kept.onNote = [](const std::string& note) { spdlog::info("{}", note); };
    return std::make_shared<KeptClouds>(kept);
}

std::shared_ptr<RemoteFiles> remoteFiles(const ServeOptions& options) {
    constexpr std::uint64_t usual = 32 << 20;
    RemoteOptions remote;
    remote.memory = std::min(usual, options.server.cache->stats().limit / 8);
    remote.reserve = [cache = std::weak_ptr(options.server.cache)](std::uint64_t bytes) {
        const auto there = cache.lock();
        return there ? there->reserve(bytes) : nullptr;
    };
    if (const std::uint64_t share = cacheShares(options).pieces; share > 0) {
        remote.folder = options.cacheDir / "remote";
        remote.folderLimit = share;
    }
    remote.onNote = [](const std::string& note) { spdlog::warn("{}", note); };
    return std::make_shared<RemoteFiles>(std::move(remote));
}

// Tells of the device once, when it is open. False when there is none: then nothing can be served.
bool reportDevice(ScancastServer& server, bool& reported) {
    if (reported) return true;
    const DeviceStatus device = server.scheduler().device();
    if (device.state == DeviceStatus::State::Opening) return true;
    reported = true;
    if (device.state == DeviceStatus::State::Failed) {
        spdlog::error("{}", device.error.message);
        return false;
    }
    spdlog::info("drawing with {}", title(device.info));
    return true;
}

// Until a signal comes (0), or there is nothing to serve with or from (1).
int waitForTheEnd(ScancastServer& server, const CloudSources& sources, const ServeOptions& options,
                  ShutdownSignals& signals, Service& service, Upkeep& upkeep) {
    const bool mayGrow = !options.server.dataRoot.empty() || !options.catalog.empty();
    bool deviceReported = false;
    while (signals.wait(std::chrono::milliseconds(100)) == 0) {
        upkeep.step([&] { service.reportReload(server); });
        service.report(server, false);
        if (!reportDevice(server, deviceReported)) return 1;
        // Later there is somebody to tell, and another reload.
        if (!mayGrow && !server.catalog().settled() && sources.failed()) {
            spdlog::error("None of the files could be loaded; there is nothing to serve.");
            return 1;
        }
    }
    return 0;
}

// Where there are other servers: their clients go to those, and are drawn for until they have. A second signal, or the end of
// the time, ends the waiting.
void moveClients(ScancastServer& server, std::chrono::seconds patience, ShutdownSignals& signals,
                 Service& service, Upkeep& upkeep) {
    using Clock = std::chrono::steady_clock;
    if (patience.count() == 0) return;
    // One has begun this, but where there is nothing to draw with; another may have come with it.
    const int before = std::min(1, signals.wait(std::chrono::milliseconds(0)));
    const auto end = Clock::now() + patience;
    spdlog::info("streams that are to go to another server within {} s: {}", patience.count(),
                 server.sessions());
    server.moveClients(patience);
    while (server.sessions() > 0 && Clock::now() < end &&
           signals.wait(std::chrono::milliseconds(50)) <= before) {
        upkeep.step();  // a token that is withdrawn meanwhile is withdrawn
        service.report(server, true);
    }
    if (server.sessions() > 0) spdlog::warn("streams that have not gone in time: {}", server.sessions());
}

// Streams are told, and what was promised is finished; then everybody is told and given time. A second
// signal, or the end of patience, ends the process as it is.
void leave(ScancastServer& server, CloudSources& sources, BlockCache& cache, RemoteFiles& remote,
           ShutdownSignals& signals, int exitCode) {
    using Clock = std::chrono::steady_clock;
    const int before = signals.wait(std::chrono::milliseconds(0));
    spdlog::info("shutting down");
    server.drain();
    sources.requestStop();
    const auto drained = Clock::now() + drainPatience;
    while (!server.drained() && Clock::now() < drained &&
           signals.wait(std::chrono::milliseconds(20)) == before) {
    }
    const auto end = Clock::now() + shutdownPatience;
    server.shutDown();
    remote.stop();
    cache.stop();
    while (!server.waitForClients(std::chrono::milliseconds(0)) || !sources.finished()) {
        if (signals.wait(std::chrono::milliseconds(20)) > before || Clock::now() >= end) {
            spdlog::warn("not everything had ended in time");
            spdlog::default_logger()->flush();
            std::_Exit(exitCode);
        }
    }
}

/// What blocks leave behind goes back to the system, or the limit would be kept in name only.
void returnMemoryOfBlocks() {
    ::mallopt(M_ARENA_MAX, 4);
    ::mallopt(M_MMAP_THRESHOLD, 64 << 10);
    ::mallopt(M_TRIM_THRESHOLD, 1 << 20);
}

void warnOfExposure(const ServeOptions& options) {
    if (isLoopbackHost(options.server.host)) return;
    if (options.server.tokens.users.empty())
        spdlog::warn("--insecure: everybody who can reach {} may see the clouds", options.server.host);
    else if (!options.server.tls.given())
        spdlog::warn(
            "without --tls-cert, the token and the pictures can be read by who sits between {} and a client",
            options.server.host);
}

void warnOfExpiry(const ServeOptions& options, const ScancastServer& server) {
    const auto tls = server.tls();
    if (!tls) return;
    const std::string warning =
        expiryWarning(*tls, options.server.tls.certificate, std::chrono::system_clock::now());
    if (!warning.empty()) spdlog::warn("{}", warning);
}

void tellOfVideo(const ServeOptions& options) {
    const std::size_t sessions = options.server.limits.videoSessions;
    const VideoPlaces video(sessions);
    const bool isLacking = sessions > 0 && video.codecs().size() == 1;
    spdlog::log(isLacking ? spdlog::level::warn : spdlog::level::info, "moving frames: {}{}", video.text(),
                isLacking ? "; they are JPEG for everybody" : "");
}

void reportEntrances(const ServeOptions& options, const ScancastServer& server) {
    const NetLimits& limits = options.server.limits;
    if (options.maxConnections == 0 &&
        limits.maxConnections < ConnectionWish{limits.maxSessions, {}, 0}.connections()) {
        spdlog::warn(
            "only {} connections fit into the files that this process may open; ulimit -Hn, or "
            "LimitNOFILE= of a systemd unit, allows more",
            limits.maxConnections);
    }
    if (!options.server.adminListen) return;
    const ListenAddress probes{options.server.adminListen->host, server.adminPort()};
    spdlog::info("probes at http://{}/healthz, /readyz and /metrics", probes.text());
    if (!isLoopbackHost(probes.host) && !options.server.tokens.users.empty())
        spdlog::warn(
            "--admin-listen is in the clear: the token that asks for /metrics can be read on the way to {}",
            probes.host);
}

void tellOfImporters(const ServeOptions& options) {
    const SandboxLine line = sandboxLine(*importOptions(options.importer));
    spdlog::log(line.sound ? spdlog::level::info : spdlog::level::warn, "{}", line.text);
}

/// Nobody is told an address where there will be nothing: files that are not there, or are none, are found out at once.
Expected<void> checkSomethingIsThere(const ServeOptions& options) {
    if (!options.live.empty() || !options.server.dataRoot.empty() || !options.catalog.empty()) return {};
    std::optional<Error> first;
    for (const auto& file : options.files) {
        if (isRemoteUrl(file.native())) return {};  // whether it can be reached may change
        const auto input = ScanInput::open(file);
        if (input) return {};
        if (!first) first = input.error();
    }
    if (!first) return {};
    if (options.files.size() > 1)
        first->message = fmt::format("None of the {} files can be opened; the first one: {}",
                                     options.files.size(), first->message);
    return tl::unexpected(std::move(*first));
}

int serve(ServeOptions options, GivenFlags given, nlohmann::json effective, const ServeParts& parts,
          const std::function<void(CLI::App&)>& moreFlags) {
    auto manager = ServiceManager::fromEnvironment();
    if (!manager) return failure(manager.error());
    if (auto log = setUpLog(options.logLevel, options.logFormat); !log) return failure(log.error());
    if (auto found = findFiles(options); !found) return failure(found.error());
    if (auto sound = check(options); !sound) return failure(sound.error());
    if (auto there = checkSomethingIsThere(options); !there) return failure(there.error());
    auto tokens = accessTokens(options);
    if (!tokens) return failure(tokens.error());
    options.server.tokens = std::move(*tokens);
    returnMemoryOfBlocks();
    keepMemoryReserve();
    options.server.rates = *rates(options);
    options.server.adminListen = *adminListen(options);
    options.server.requestLog = *requestLog(options);  // sound: check() has said so
    options.server.proxies = *TrustedProxies::parse(options.trustedProxies);
    options.server.limits.maxConnections = *maxConnections(options);
    const MemoryShares shares = *memoryShares(options);
    const auto damage = std::make_shared<DamageReports>();
    options.server.cache = blockCache(shares.clouds, damage);
    if (parts.clouds) options.server.cache = parts.clouds(std::move(options.server.cache));
    options.server.ranks = parts.ranks;
    options.server.scheduler.memory = TransientMemory(shares.transient);
    options.server.scheduler.encodeThreads = options.device.threads;
    options.server.scheduler.maxFrameBytes = options.server.scheduler.memory.forFrames();
    options.server.kept = keptClouds(options);
    options.server.remote = remoteFiles(options);
    options.device.programFolder = programFolder(options.cacheDir);
    options.device.gpuMemoryLimit = *parseGpuMemoryLimit(options.gpuMemoryLimit);
    ShutdownSignals signals(ShutdownSignals::Hangup::Reloads);
    auto server = ScancastServer::create(
        options.server, parts.painter ? parts.painter(options.device) : devicePainter(options.device));
    if (!server) return failure(server.error());
    std::printf("Open %s\n", (*server)->url().c_str());
    std::fflush(stdout);
    reportEntrances(options, **server);
    warnOfExposure(options);
    warnOfExpiry(options, **server);
    tellOfImporters(options);
    tellOfVideo(options);
    ProgressBar bar(stderr,
                    options.logFormat == "json" ? ProgressBar::Style::Quiet : ProgressBar::Style::Automatic);
    CloudSources sources(options, damage, **server, bar);
    (*server)->admin().loadWith([&sources](ScanInput input, const std::string& id) {
        return sources.loader().load(std::move(input), id);
    });
    Service service(std::move(*manager));
    Reload reload({std::move(given), std::move(effective), moreFlags}, options, **server, sources);
    Upkeep upkeep(sources, reload, signals);
    const int exitCode = waitForTheEnd(**server, sources, options, signals, service, upkeep);
    service.report(**server, true);
    bar.clear();
    moveClients(**server, std::chrono::seconds(options.drainSeconds), signals, service, upkeep);
    (*server)->admin().loadWith({});
    leave(**server, sources, *options.server.cache, *options.server.remote, signals, exitCode);
    return exitCode;
}

// What only a look at the files can tell.
int checkConfig(const CLI::App& command, ServeOptions options) {
    if (auto found = findFiles(options); !found) return failure(found.error());
    if (auto sound = check(options); !sound) return failure(sound.error());
    if (auto there = checkSomethingIsThere(options); !there) return failure(there.error());
    if (auto tokens = accessTokens(options); !tokens) return failure(tokens.error());
    if (options.server.tls.given()) {
        if (auto tls = openTls(options.server.tls); !tls) return failure(tls.error());
    }
    const auto printed = print(plainJson(effectiveConfig(command).dump(4)) + "\n");
    return printed ? 0 : failure(printed.error());
}

int run(CLI::App& command, ServeOptions& options, const ServeCommand& serves) {
    GivenFlags given = givenFlags(command);
    if (!options.config.empty()) {
        if (auto applied = applyConfigFile(command, options.config); !applied)
            return failure(applied.error());
    }
    if (options.checkConfig) return checkConfig(command, options);
    return serves.as(options, [&](const ServeParts& parts) {
        return serve(options, std::move(given), effectiveConfig(command), parts, serves.flags);
    });
}

}  // namespace

void addServe(CLI::App& app, int& exitCode) {
    CLI::App* const command =
        addServeAs(app, exitCode,
                   {.description = "Serve clouds to browsers and programs",
                    .as = [](ServeOptions&, const ServeWith& serve) { return serve({}); }});
    command->footer(
        "Every option can also be set in the environment: --max-pixels is SCANCAST_MAX_PIXELS.\n"
        "Example: scancast serve town.las room.ply --port 9000\n"
        "         scancast serve scans/                # every scan and cloud file in the folder\n"
        "         scancast serve city.scan --memory-limit 2G\n"
        "         scancast serve s3://scans/city.scan --cache-dir /var/cache/scancast   # credentials: "
        "AWS_...\n"
        "         scancast serve https://storage.example.org/city.scan\n"
        "         scancast generate statue --points 100k --frames 0 -o - | scancast serve --live statue=-\n"
        "         scancast serve --config /etc/scancast.json --check-config");
}

CLI::App* addServeAs(CLI::App& app, int& exitCode, ServeCommand serve) {
    auto options = std::make_shared<ServeOptions>();
    CLI::App* const command = app.add_subcommand(serve.name, serve.description);
    addServeFlags(*command, *options);
    if (serve.flags) serve.flags(*command);
    command->callback([options, command, serve = std::move(serve), &exitCode] {
        exitCode = run(*command, *options, serve);
    });
    return command;
}

}  // namespace scancast
