// `scancast-ranks draw`: what a front (front_command.cpp) has mpirun start: ranks that draw together for the front, of which the first
// one is told what. They end when the front does, and when one of them does.
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>

#include <memory>
#include <string>
#include <utility>

#include "protocol/flags/exit_codes.hpp"
#include "ranks/commands.hpp"
#include "ranks/draw/rank_resources.hpp"
#include "ranks/draw/ranks_device.hpp"
#include "ranks/front/first_rank.hpp"
#include "ranks/front/heartbeat.hpp"
#include "ranks/mpi/session.hpp"
#include "server/base/byte_size.hpp"
#include "server/base/log.hpp"
#include "server/commands/serve_options.hpp"
#include "server/server.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

struct RanksDrawArguments {
    std::string door, memoryLimit, logLevel = "info", logFormat = "text";
    int threads = 0;
};

/// What would keep this rank from drawing, before one waits for another.
Expected<void> checkDrawingRank(const RanksDrawArguments& arguments, int threads) {
    if (auto log = setUpLog(arguments.logLevel, arguments.logFormat); !log) return log;
    return canDraw(threads);
}

std::shared_ptr<BlockCache> shareCache(std::uint64_t limit, int threads) {
    BlockCacheOptions options;
    options.memoryLimit = limit;
    options.threads = threads;
    options.onDamaged = [](const std::shared_ptr<const CloudFile>& file, const Error& error) {
        spdlog::error("{}: {}", file->path().filename().string(), error.message);
    };
    return BlockCache::create(options);
}

Expected<void> drawForFront(const RanksDrawArguments& arguments) {
    // Where mpirun is killed nobody else ends what it has started.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    yieldWhileWaiting();
    auto mpi = MpiSession::start({});
    if (!mpi) return passOn(mpi);
    const Communicator& ranks = (*mpi)->world();
    const Communicator opening(ranks.handle(), {}), beating(ranks.handle(), {});
    const int threads = arguments.threads > 0 ? arguments.threads : threadsOfRank(**mpi);
    const auto limit = leastOfRanks(ranks, arguments.memoryLimit.empty()
                                               ? Expected<std::uint64_t>(memoryOfRank(**mpi))
                                               : parseByteSize(arguments.memoryLimit, "ranks-memory"));
    if (!limit) return ranks.isFirst() ? passOn(limit) : Expected<void>();
    ServeOptions like;  // as in a server, pictures that are drawn have their part
    like.memoryLimit = std::to_string(*limit);
    const auto shares = memoryShares(like);  // the same on all ranks
    if (!shares) return ranks.isFirst() ? passOn(shares) : Expected<void>();
    if (auto sound = ranks.agree(checkDrawingRank(arguments, threads)); !sound)
        return ranks.isFirst() ? sound : Expected<void>();
    std::unique_ptr<JobSocket> front;
    Expected<void> reached;
    if (ranks.isFirst()) {
        auto socket = JobSocket::connect(arguments.door);
        if (socket)
            front = std::move(*socket);
        else
            reached = passOn(socket);
    }
    if (auto all = ranks.agree(reached); !all) return ranks.isFirst() ? all : Expected<void>();
    OpenedClouds clouds(shareCache(shares->clouds, threads),
                        {std::uint32_t(ranks.rank()), std::uint32_t(ranks.size())}, opening);
    if (!ranks.isFirst()) {
        const Heartbeat heartbeat(beating, [] {});
        return drawWithFirst(ranks, clouds, threads);
    }
    const JobHello hello{std::string(scancastVersion()), std::uint32_t(ranks.size())};
    if (auto ok = front->send(JobWord::Hello, 0, pack(hello)); !ok) MpiSession::abortAll(ok.error().message);
    FirstRank first(ranks, clouds, *front);
    const Heartbeat heartbeat(beating, [&first] { first.tellBeat(); });
    return first.serveFront(threads);
}

}  // namespace

void addRanksDraw(CLI::App& app, int& exitCode) {
    CLI::App* const command = app.add_subcommand("draw", "What scancast-ranks front starts; not for people");
    command->group("");  // not in the help
    const auto arguments = std::make_shared<RanksDrawArguments>();
    command->add_option("--door", arguments->door, "Where the front waits")->required();
    command->add_option("--threads", arguments->threads, "CPU threads of a rank")->check(CLI::Range(0, 1024));
    command->add_option("--memory-limit", arguments->memoryLimit, "Of a rank");
    command->add_option("--log-level", arguments->logLevel, "As serve has it");
    command->add_option("--log-format", arguments->logFormat, "As serve has it");
    command->callback([arguments, &exitCode] {
        if (auto done = drawForFront(*arguments); !done) {
            tell("scancast-ranks draw: {}\n", done.error().message);
            exitCode = exitFailed;
        }
    });
}

}  // namespace scancast
