// `scancast-ranks serve`: the server, whose pictures all ranks draw. Rank 0 is all of it, with a device that the others draw for
// (ranks/draw/ranks_device.hpp).
#include "ranks/commands.hpp"

#include <spdlog/spdlog.h>

#include <csignal>
#include <string>
#include <utility>

#include "ranks/draw/rank_resources.hpp"
#include "ranks/draw/ranks_device.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/base/log.hpp"
#include "server/commands/serve/serve.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

int serveFailed(const Error& error) {
    tell("scancast-ranks serve: {}\n", error.message);
    return 1;
}

NodeShare shareOf(const Communicator& ranks) {
    return {std::uint32_t(ranks.rank()), std::uint32_t(ranks.size())};
}

/// Scans would be read by rank 0 alone.
Expected<void> checkClouds(ServeOptions options) {
    if (options.device.backend != "auto" && options.device.backend != "cpu")
        return fail(ErrorCode::InvalidArgument,
                    "Ranks draw with the cpu device; leave --backend out, or say --backend=cpu.", "backend");
    if (auto found = findFiles(options); !found) return found;
    for (const auto& file : options.files)
        if (!isCloudFileAt(file))
            return fail(ErrorCode::InvalidArgument,
                        file.string() +
                            " is no cloud file, which is what ranks share: ingest it first, as in scancast "
                            "ingest " +
                            file.string() + " -o " + file.stem().string() + ".scan");
    return {};
}

/// Rank 0: pictures of what it has opened, by all.
OpenPainter ranksPainter(const Communicator& ranks, std::shared_ptr<SharedClouds> clouds, int threads,
                         RankTraffic& traffic) {
    const OpenPainter ofDevice = painterWith(
        [&ranks, clouds, threads, &traffic] { return createRanksDevice(ranks, clouds, threads, traffic); });
    return [ofDevice, clouds]() -> Expected<Painter> {
        auto painter = ofDevice();
        if (!painter) return painter;
        painter->begin = [begin = std::move(painter->begin), clouds](
                             const PictureOrder& order, const PreparedPicture& prepared, std::stop_token stop,
                             const Pause& pause) {
            clouds->know(*order.cloud);
            return begin(order, prepared, std::move(stop), pause);
        };
        return painter;
    };
}

int serveAsFirst(const Communicator& ranks, const ServeOptions& options, const ServeWith& serve) {
    RankTraffic traffic;
    std::shared_ptr<SharedClouds> clouds;
    ServeParts parts;
    parts.clouds = [&](std::shared_ptr<BlockCache> cache) {
        return clouds = std::make_shared<SharedClouds>(std::move(cache), shareOf(ranks));
    };
    parts.painter = [&](const DeviceOptions& device) {
        return ranksPainter(ranks, clouds, device.threads, traffic);
    };
    auto sound = checkClouds(options);
    const int exitCode = sound ? serve(parts) : serveFailed(sound.error());
    if (auto ok = letGo(ranks); !ok) return serveFailed(ok.error());
    return exitCode;
}

int serveAsOther(const Communicator& ranks, const ServeOptions& options) {
    // Rank 0 says when it is over, and it is told by the same signals.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
    if (auto log = setUpLog(options.logLevel, options.logFormat); !log) return 1;  // rank 0 says so
    const auto shares = memoryShares(options);
    if (!shares) return 1;
    BlockCacheOptions cache;
    cache.memoryLimit = shares->clouds;
    cache.onDamaged = [](const std::shared_ptr<const CloudFile>& file, const Error& error) {
        spdlog::error("{}: {}", file->path().filename().string(), error.message);
    };
    OpenedClouds clouds(BlockCache::create(cache), shareOf(ranks));
    if (auto done = drawWithFirst(ranks, std::move(clouds), options.device.threads); !done)
        return serveFailed(done.error());
    return 0;
}

int serveByRanks(ServeOptions& options, const ServeWith& serve) {
    yieldWhileWaiting();
    auto mpi = MpiSession::start({});
    if (!mpi) return serveFailed(mpi.error());
    if (options.memoryLimit.empty()) options.memoryLimit = std::to_string(memoryOfRank(**mpi));
    if (options.device.threads == 0) options.device.threads = threadsOfRank(**mpi);
    const Communicator& ranks = (*mpi)->world();
    return ranks.isFirst() ? serveAsFirst(ranks, options, serve) : serveAsOther(ranks, options);
}

}  // namespace

void addRanksServe(CLI::App& app, int& exitCode) {
    CLI::App* const command = addServeAs(
        app, exitCode,
        "Serve clouds whose pictures all ranks draw together, each with a share of every cloud in memory. "
        "Rank 0 has the "
        "network; every rank needs the cloud files under the same names. Memory and threads are a rank's",
        serveByRanks);
    command->footer(
        "Example: mpirun -n 4 scancast-ranks serve city.scan --memory-limit 8G --threads 4\n"
        "         mpirun -n 8 --hostfile machines scancast-ranks serve /shared/country.scan");
}

}  // namespace scancast
