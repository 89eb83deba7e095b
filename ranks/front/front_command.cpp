// `scancast-ranks front`: the server, before ranks that it starts itself and starts again when they are lost. It draws with them what
// they can draw, and alone what they cannot.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "files/machine.hpp"
#include "protocol/flags/exit_codes.hpp"
#include "ranks/commands.hpp"
#include "ranks/front/front_clouds.hpp"
#include "ranks/front/front_device.hpp"
#include "ranks/front/job_keeper.hpp"
#include "renderer/plan.hpp"
#include "server/base/byte_size.hpp"
#include "server/commands/serve/serve.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

/// Until the ranks are there, or have failed for the first time, nobody is drawn for.
constexpr auto waitsForRanks = std::chrono::seconds(10);
/// Of the machine's memory, where nobody says: the ranks on it have half.
constexpr std::uint64_t frontsPart = 8;

struct FrontFlags {
    std::string start = "mpirun --bind-to none";
    std::string ranksMemory;  ///< as written; empty = as scancast-ranks serve has it
    int ranksThreads = 0;
};

void addFrontFlags(CLI::App& app, FrontFlags& flags) {
    app.add_option(
           "--start", flags.start,
           "The command that starts ranks, without the program: mpirun, how many there are to be, and "
           "where. The first one has to be on this machine")
        ->type_name("COMMAND")
        ->envname("SCANCAST_START")
        ->capture_default_str();
    app.add_option(
           "--ranks-memory", flags.ranksMemory,
           "Memory of each rank for its share of the clouds, such as 8G. Default: of half of its machine's, "
           "as much as each other rank on it")
        ->type_name("SIZE")
        ->envname("SCANCAST_RANKS_MEMORY");
    app.add_option("--ranks-threads", flags.ranksThreads,
                   "CPU threads of each rank; 0 = its machine's cores, shared out")
        ->type_name("N")
        ->envname("SCANCAST_RANKS_THREADS")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
}

int frontFailed(const Error& error) {
    tell("scancast-ranks front: {}\n", error.message);
    return exitUsage;
}

/// The command that each rank is.
std::vector<std::string> drawWords(const FrontFlags& flags, const ServeOptions& options) {
    std::error_code unknown;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", unknown);
    std::vector<std::string> words{unknown ? "scancast-ranks" : self.string(), "draw"};
    const auto add = [&words](const char* flag, std::string value) {
        words.emplace_back(flag);
        words.push_back(std::move(value));
    };
    add("--threads", std::to_string(flags.ranksThreads));
    if (!flags.ranksMemory.empty()) add("--memory-limit", flags.ranksMemory);
    add("--log-level", options.logLevel);
    add("--log-format", options.logFormat);
    return words;
}

/// What it was planned with holds: how much may be in memory is known for certain once the ranks have opened the cloud.
bool isPlanSound(const PictureOrder& order) {
    const auto most = mostSamples(*order.cloud);
    if (!order.planned || !most) return true;
    return order.planned->selection.budget == std::min(order.view.quality.budget.value_or(*most), *most);
}

/// Prepares a picture again when somebody else has begun to draw its cloud meanwhile: it would be half of either.
PreparePicture preparedOfOneState(PreparePicture prepare) {
    return [prepare = std::move(prepare)](const PictureOrder& order, bool wait,
                                          std::stop_token stop) -> Expected<PreparedPicture> {
        for (;;) {
            const std::uint64_t before = FrontClouds::changesOf(*order.cloud);
            PictureOrder unplanned;
            const bool isSound = isPlanSound(order);
            if (!isSound) {
                unplanned = order;
                unplanned.planned.reset();
            }
            auto prepared = prepare(isSound ? order : unplanned, wait, stop);
            if (stop.stop_requested() || FrontClouds::changesOf(*order.cloud) == before) return prepared;
        }
    };
}

OpenPainter frontPainter(JobKeeper& keeper, std::shared_ptr<FrontClouds> clouds, int threads) {
    const OpenPainter ofDevice =
        painterWith([&keeper, clouds, threads] { return createFrontDevice(keeper, clouds, threads); });
    return [ofDevice, &keeper, clouds]() -> Expected<Painter> {
        auto painter = ofDevice();
        if (!painter) return painter;
        keeper.waitForFirstStart(waitsForRanks);
        painter->prepare = preparedOfOneState(std::move(painter->prepare));
        painter->begin = [begin = std::move(painter->begin), clouds](
                             const PictureOrder& order, const PreparedPicture& prepared, std::stop_token stop,
                             const Pause& pause) {
            clouds->know(order.cloud);
            return begin(order, prepared, std::move(stop), pause);
        };
        return painter;
    };
}

int serveBeforeRanks(const FrontFlags& flags, ServeOptions& options, const ServeWith& serve) {
    if (options.device.backend != "auto" && options.device.backend != "cpu")
        return frontFailed({ErrorCode::InvalidArgument,
                            "Ranks draw with the cpu device; leave --backend out, or say --backend=cpu.",
                            {}});
    auto start = wordsOfLine(flags.start);
    if (!start) return frontFailed({start.error().code, "--start: " + start.error().message, {}});
    if (!flags.ranksMemory.empty()) {
        const auto size = parseByteSize(flags.ranksMemory, "ranks-memory");
        if (!size) return frontFailed(size.error());
        ServeOptions rank;
        rank.memoryLimit = flags.ranksMemory;
        if (!memoryShares(rank))
            return frontFailed({ErrorCode::InvalidArgument,
                                "--ranks-memory: 64M is the least that a picture can be drawn with.",
                                "ranks-memory"});
    }
    if (options.memoryLimit.empty()) options.memoryLimit = std::to_string(machineMemory() / frontsPart);
    JobKeeper keeper(std::move(*start), drawWords(flags, options));
    std::shared_ptr<FrontClouds> clouds;
    ServeParts parts;
    parts.clouds = [&](std::shared_ptr<BlockCache> cache) {
        clouds = std::make_shared<FrontClouds>(
            std::move(cache), keeper, [](const std::string& sentence) { spdlog::warn("{}", sentence); });
        keeper.begin(clouds);
        return clouds;
    };
    parts.painter = [&](const DeviceOptions& device) { return frontPainter(keeper, clouds, device.threads); };
    parts.ranks = [&keeper] {
        const JobStatus status = keeper.status();
        return RanksStats{status.isUp, status.restarts};
    };
    const int exitCode = serve(parts);
    if (clouds) clouds->close();
    return exitCode;
}

}  // namespace

void addRanksFront(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<FrontFlags>();
    CLI::App* const command = addServeAs(
        app, exitCode,
        {.name = "front",
         .description =
             "Serve clouds whose pictures ranks draw together, and go on when a rank is lost: this program "
             "is the "
             "server, starts the ranks itself, and starts them again. Until they are back it draws coarser "
             "pictures by itself. Every rank needs the cloud files under the same names",
         .as = [flags](ServeOptions& options,
                       const ServeWith& serve) { return serveBeforeRanks(*flags, options, serve); },
         .flags = [flags](CLI::App& to) { addFrontFlags(to, *flags); }});
    command->get_option("FILE")->description(
        "What to serve. Ranks draw cloud files on disk, under the same names everywhere; everything else is "
        "drawn "
        "without them");
    command->get_option("--memory-limit")
        ->description(
            "Memory of the server itself, for what it draws without ranks. Default: an eighth of the "
            "machine's");
    command->footer(
        "Example: scancast-ranks front city.scan --start 'mpirun -n 4 --bind-to none' --ranks-memory 8G\n"
        "         scancast-ranks front /shared/country.scan --start 'mpirun --hostfile machines -N 1 "
        "--bind-to none'");
}

}  // namespace scancast
