// `scancast-ranks serve`: the server, whose pictures all ranks draw. Rank 0 is all of it, with a device that the others draw for
// (ranks/draw/ranks_device.hpp).
#include "ranks/commands.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <span>
#include <string>
#include <utility>

#include "ranks/draw/rank_resources.hpp"
#include "ranks/draw/ranks_device.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/base/byte_size.hpp"
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

/// Scans would be read by rank 0 alone. The files that were found, by name and revision.
Expected<std::string> checkClouds(ServeOptions options) {
    if (options.device.backend != "auto" && options.device.backend != "cpu")
        return fail(ErrorCode::InvalidArgument,
                    "Ranks draw with the cpu device; leave --backend out, or say --backend=cpu.", "backend");
    if (auto found = findFiles(options); !found) return passOn(found);
    std::string all;
    for (const auto& file : options.files) {
        if (!isCloudFileAt(file))
            return fail(ErrorCode::InvalidArgument, file.string() +
                                                        " is no cloud file here, which is what ranks share; "
                                                        "a scan is to be ingested first, as in "
                                                        "scancast ingest " +
                                                        file.string() + " -o " + file.stem().string() +
                                                        ".scan");
        const auto opened = CloudFile::open(file);  // what cannot be read, the server tells
        all += file.string() + ' ' + (opened ? (*opened)->facts().revision : "(unreadable)") + '\n';
    }
    return all;
}

/// What would keep this rank from serving.
Expected<std::string> checkRank(const Communicator& ranks, const ServeOptions& options) {
    // Rank 0's log is the server's.
    if (!ranks.isFirst())
        if (auto log = setUpLog(options.logLevel, options.logFormat); !log) return passOn(log);
    if (auto shares = memoryShares(options); !shares) return passOn(shares);
    if (auto can = canDraw(options.device.threads); !can) return passOn(can);
    return checkClouds(options);
}

/// All ranks, before one waits for another: whatever is the matter with one of them is everybody's, and rank 0 says it.
Expected<void> checkRanks(const Communicator& ranks, const ServeOptions& options) {
    const auto telling = [&](Error error) {
        if (!ranks.isFirst())
            error.message = "On rank " + std::to_string(ranks.rank()) + ": " + error.message;
        return tl::unexpected(std::move(error));
    };
    auto checked = checkRank(ranks, options);
    if (!checked) checked = telling(checked.error());
    const auto mine = ranks.agree(std::move(checked));
    if (!mine) return passOn(mine);
    const auto bytes = std::as_bytes(std::span(*mine));
    RankBytes first(bytes.begin(), bytes.end());
    if (auto ok = ranks.broadcast(first); !ok) return ok;
    Expected<void> same;
    if (!std::ranges::equal(first, bytes))
        same = telling(
            {ErrorCode::InvalidArgument,
             "there are other cloud files, or others of the same names, than at rank 0; every rank needs the "
             "same: " +
                 *mine,
             {}});
    return ranks.agree(same);
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
            clouds->know(order.cloud);
            return begin(order, prepared, std::move(stop), pause);
        };
        return painter;
    };
}

int serveAsFirst(const Communicator& ranks, const Communicator& opening, const ServeWith& serve) {
    RankTraffic traffic;
    std::shared_ptr<SharedClouds> clouds;
    ServeParts parts;
    parts.clouds = [&](std::shared_ptr<BlockCache> cache) {
        return clouds = std::make_shared<SharedClouds>(
                   std::move(cache), shareOf(ranks), opening,
                   [](const std::string& sentence) { spdlog::warn("{}", sentence); });
    };
    parts.painter = [&](const DeviceOptions& device) {
        return ranksPainter(ranks, clouds, device.threads, traffic);
    };
    const int exitCode = serve(parts);
    if (clouds) clouds->close();
    if (auto ok = letGo(ranks, opening); !ok) return serveFailed(ok.error());
    return exitCode;
}

int serveAsOther(const Communicator& ranks, const Communicator& opening, const ServeOptions& options) {
    // Rank 0 says when it is over, and it is told by the same signals.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
    const auto shares = memoryShares(options);
    if (!shares) MpiSession::abortAll(shares.error().message);  // it was there when they agreed
    BlockCacheOptions cache;
    cache.memoryLimit = shares->clouds;
    cache.onDamaged = [](const std::shared_ptr<const CloudFile>& file, const Error& error) {
        spdlog::error("{}: {}", file->path().filename().string(), error.message);
    };
    OpenedClouds clouds(BlockCache::create(cache), shareOf(ranks), opening);
    if (auto done = drawWithFirst(ranks, clouds, options.device.threads); !done)
        return serveFailed(done.error());
    return 0;
}

int serveByRanks(ServeOptions& options, const ServeWith& serve) {
    yieldWhileWaiting();
    auto mpi = MpiSession::start({});
    if (!mpi) return serveFailed(mpi.error());
    if (options.device.threads == 0) options.device.threads = threadsOfRank(**mpi);
    const Communicator& ranks = (*mpi)->world();
    const Communicator opening(ranks.handle(), {});
    const auto limit =
        leastOfRanks(ranks, options.memoryLimit.empty() ? Expected<std::uint64_t>(memoryOfRank(**mpi))
                                                        : parseByteSize(options.memoryLimit, "memory-limit"));
    if (limit) options.memoryLimit = std::to_string(*limit);
    const auto sound = limit ? checkRanks(ranks, options) : Expected<void>(passOn(limit));
    if (!sound) return ranks.isFirst() ? serveFailed(sound.error()) : 1;
    return ranks.isFirst() ? serveAsFirst(ranks, opening, serve) : serveAsOther(ranks, opening, options);
}

}  // namespace

void addRanksServe(CLI::App& app, int& exitCode) {
    CLI::App* const command = addServeAs(
        app, exitCode,
        {.description =
             "Serve clouds whose pictures all ranks draw together, each with a share of every cloud in "
             "memory. "
             "Rank 0 has the network; every rank needs the cloud files under the same names. Memory and "
             "threads are a rank's",
         .as = serveByRanks});
    command->get_option("FILE")->description(
        "The cloud files to serve, on disk, under the same names on every rank");
    command->footer(
        "Example: mpirun -n 4 --bind-to none scancast-ranks serve city.scan --memory-limit 8G --threads 4\n"
        "         mpirun --hostfile machines -N 1 --bind-to none scancast-ranks serve /shared/country.scan");
}

}  // namespace scancast
