// `scancast-ranks render`: one picture of a cloud file by all ranks, and what it took them.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "files/output_file.hpp"
#include "protocol/flags/exit_codes.hpp"
#include "protocol/flags/view_flags.hpp"
#include "protocol/text/plain_text.hpp"
#include "protocol/view/view_words.hpp"
#include "ranks/commands.hpp"
#include "ranks/draw/rank_resources.hpp"
#include "ranks/draw/ranks_device.hpp"
#include "renderer/image/encode.hpp"
#include "renderer/plan.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/base/byte_size.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

struct RanksRenderArguments {
    std::string file, output, stats, memoryLimit;
    ViewFlags view;
    int threads = 0, repeat = 1;
    double orbit = 0;  ///< degrees around the target between repeated pictures
};

double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Of all repetitions, and what rank 0 gave to reductions.
struct RanksTimes {
    std::vector<double> whole;
    std::vector<std::string> order;
    std::map<std::string, std::vector<double>> stages;
    RankTraffic traffic;

    void add(double ms, const FrameStats& stats) {
        whole.push_back(ms);
        for (const auto& stage : stats.stages) {
            if (!stages.contains(stage.name)) order.push_back(stage.name);
            stages[stage.name].push_back(stage.milliseconds);
        }
    }
    std::string json(int ranks, const Frame& frame) const {
        nlohmann::ordered_json json;
        json["ranks"] = ranks;
        json["frames"] = whole.size();
        json["medianMs"] = medianOf(whole);
        json["bestMs"] = *std::ranges::min_element(whole);
        json["samples"] = frame.stats.samplesDrawn;
        json["method"] = frame.stats.method;
        json["bytesSentPerFrame"] = traffic.bytes / whole.size();
        json["bytesReceivedPerFrame"] = traffic.received / whole.size();
        json["exchangesPerFrame"] = double(traffic.exchanges) / double(whole.size());
        json["stages"] = nlohmann::ordered_json::array();
        for (const auto& name : order)
            json["stages"].push_back({{"name", name}, {"medianMs", medianOf(stages.at(name))}});
        return plainJson(json.dump());
    }
};

Expected<Bytes> encoded(const Frame& frame, const View& view, const fs::path& file, int threads) {
    if (file.extension() != ".png")
        return encodeJpeg(frame, view.quality.jpegQuality, view.quality.subsampling, threads);
    return encodePng(frame, view.style.background.kind == Background::Kind::Transparent);
}

Expected<std::uint64_t> memoryLimitOf(const RanksRenderArguments& arguments, const MpiSession& mpi) {
    if (arguments.memoryLimit.empty()) return memoryOfRank(mpi);
    return parseByteSize(arguments.memoryLimit, "memory-limit");
}

/// Rank 0. The view, and pictures of it.
Expected<void> renderAsFirst(const Communicator& ranks, const std::shared_ptr<SharedClouds>& clouds,
                             const RanksRenderArguments& arguments, int threads) {
    const auto words = arguments.view.words();
    if (!words) return passOn(words);
    const auto cloud = openCloud(arguments.file, clouds);
    if (!cloud) return passOn(cloud);
    clouds->know(*cloud);
    auto view = applyWords(defaultView(**cloud), *words);
    if (!view) return passOn(view);
    if (!view->with.empty())
        return fail(ErrorCode::Unsupported,
                    "with: ranks draw one cloud at a time; scancast render shows several together", "with");
    RanksTimes times;
    auto device = createRanksDevice(ranks, clouds, threads, times.traffic);
    if (!device) return passOn(device);
    Frame frame;
    for (int i = 0; i < arguments.repeat; ++i) {
        const auto start = std::chrono::steady_clock::now();
        auto drawn = render(**device, **cloud, *view, {.depth = false});
        if (!drawn) return passOn(drawn);
        frame = std::move(*drawn);
        times.add(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count(),
                  frame.stats);
        Camera& camera = view->camera;
        const glm::dmat4 turn = glm::rotate(glm::dmat4(1), glm::radians(arguments.orbit), camera.up);
        if (arguments.orbit != 0 && i + 1 < arguments.repeat)
            camera.eye = camera.target + glm::dvec3(turn * glm::dvec4(camera.eye - camera.target, 0));
    }
    if (!arguments.output.empty()) {
        const auto bytes = encoded(frame, *view, arguments.output, threads);
        if (!bytes) return passOn(bytes);
        if (auto ok = writeWholeFile(arguments.output, std::as_bytes(std::span(*bytes))); !ok) return ok;
    }
    if (arguments.stats.empty()) return {};
    return print(times.json(ranks.size(), frame) + "\n");
}

Expected<void> renderByRanks(const RanksRenderArguments& arguments) {
    yieldWhileWaiting();
    auto mpi = MpiSession::start({});
    if (!mpi) return passOn(mpi);
    const Communicator& ranks = (*mpi)->world();
    const int threads = arguments.threads > 0 ? arguments.threads : threadsOfRank(**mpi);
    const Communicator opening(ranks.handle(), {});
    const auto limit = leastOfRanks(ranks, memoryLimitOf(arguments, **mpi));
    if (!limit) return ranks.isFirst() ? passOn(limit) : Expected<void>();
    if (auto sound = ranks.agree(canDraw(threads)); !sound) return ranks.isFirst() ? sound : Expected<void>();
    BlockCacheOptions options;
    options.memoryLimit = *limit;
    options.threads = threads;
    const NodeShare share{std::uint32_t(ranks.rank()), std::uint32_t(ranks.size())};
    auto cache = BlockCache::create(options);
    if (!ranks.isFirst()) {
        OpenedClouds clouds(std::move(cache), share, opening);
        return drawWithFirst(ranks, clouds, threads);
    }
    const auto clouds = std::make_shared<SharedClouds>(
        std::move(cache), share, opening,
        [](const std::string& sentence) { tell("scancast-ranks render: {}\n", sentence); });
    auto done = renderAsFirst(ranks, clouds, arguments, threads);
    clouds->close();
    if (auto ok = letGo(ranks, opening); !ok && done) return ok;
    return done;
}

Expected<void> checkRanksRender(const RanksRenderArguments& arguments) {
    const fs::path ending = fs::path(arguments.output).extension();
    if (!arguments.output.empty() && ending != ".png" && ending != ".jpg" && ending != ".jpeg")
        return fail(ErrorCode::InvalidArgument,
                    "the picture's name must end in .png, .jpg or .jpeg, not '" + arguments.output + "'");
    if (arguments.output.empty() && arguments.stats.empty())
        return fail(ErrorCode::InvalidArgument,
                    "nothing to do: name a picture (-o FILE.png) or ask for --stats json");
    return {};
}

}  // namespace

void addRanksRender(CLI::App& app, int& exitCode) {
    CLI::App* const command = app.add_subcommand(
        "render",
        "Render one picture of a cloud file by all ranks, each with a share of it in memory: the same bytes "
        "as scancast render writes");
    command->footer(
        "Example: mpirun -n 4 --bind-to none scancast-ranks render city.scan -o city.png --method ewa");
    auto arguments = std::make_shared<RanksRenderArguments>();
    command->add_option("FILE", arguments->file, "The cloud file")->required();
    command->add_option("-o,--output", arguments->output, "The picture to write: .png, .jpg or .jpeg");
    command
        ->add_option("--threads", arguments->threads,
                     "CPU threads of a rank; 0 = the machine's cores, shared out")
        ->check(CLI::Range(0, 1024));
    command
        ->add_option("--memory-limit", arguments->memoryLimit,
                     "A rank's memory for its share, such as 2G. Default: of half of the machine's, as much "
                     "as each other "
                     "rank on it")
        ->type_name("SIZE");
    command->add_option("--repeat", arguments->repeat, "Render N times and report medians")
        ->check(CLI::Range(1, 1000000));
    command->add_option("--orbit", arguments->orbit,
                        "Turn about the target by this many degrees between repetitions");
    command
        ->add_option("--stats", arguments->stats,
                     "Print timings and rank 0's traffic on standard output, as JSON")
        ->check(CLI::IsMember({"json"}));
    arguments->view.addTo(*command);
    command->callback([arguments, &exitCode] {
        if (auto sound = checkRanksRender(*arguments); !sound) {
            tell("scancast-ranks render: {}\n", sound.error().message);
            exitCode = exitUsage;
        } else if (auto done = renderByRanks(*arguments); !done) {
            tell("scancast-ranks render: {}\n", done.error().message);
            exitCode = exitFailed;
        }
    });
}

}  // namespace scancast
