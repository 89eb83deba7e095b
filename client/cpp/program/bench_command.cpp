// `scancast-client bench`: many sessions at once, each with a behaviour, and what they see.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "client/cpp/program/bench_report.hpp"
#include "client/cpp/program/command.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/json_text.hpp"
#include "protocol/view/view_json.hpp"

namespace scancast::client {
namespace {

struct BenchFlags {
    CloudFlags cloud;
    ViewFlags view;
    BenchOptions options;
    CodecFlag codec;
    std::array<int, behaviours.size()> sessions{};
    std::string final;
    bool json = false;
};

/// For scripts that look at the server meanwhile.
void tell(const char* phase) {
    sayOn(stderr, "bench: %s\n", phase);
    std::fflush(stderr);
}

void sleepUntil(std::chrono::steady_clock::time_point start, double seconds) {
    std::this_thread::sleep_until(start + std::chrono::microseconds(std::int64_t(seconds * 1e6)));
}

std::vector<BenchResult> runSessions(const Server& server, const BenchFlags& flags) {
    const auto& options = flags.options;
    std::vector<Behaviour> wanted;
    for (std::size_t i = 0; i < behaviours.size(); ++i)
        wanted.insert(wanted.end(), static_cast<std::size_t>(flags.sessions[i]), behaviours[i]);
    std::vector<BenchResult> results(wanted.size());
    BenchClock clock;
    clock.notReady = static_cast<int>(wanted.size());
    if (options.wake) clock.unanswered = flags.sessions[std::size_t(Behaviour::Idle)];
    tell("connecting");
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < wanted.size(); ++i)
        threads.emplace_back(
            [&, i] { results[i] = benchSession(server, options, wanted[i], static_cast<int>(i), clock); });
    while (clock.notReady > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto start = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
    clock.start = std::chrono::nanoseconds(start.time_since_epoch()).count();
    sleepUntil(start, options.warmUp);
    tell("measuring");
    sleepUntil(start, options.warmUp + options.seconds);
    tell("measured");
    threads.clear();
    return results;
}

/// The first final still of all, and beside it the view that it shows.
Expected<void> writeFinal(const std::string& path, const std::vector<BenchResult>& results) {
    for (const auto& result : results) {
        if (result.final.empty() || !result.finalMs) continue;
        const auto view = printJson(toJson(result.finalView));
        return writeFile(path, result.final).and_then([&] {
            return writeFile(path + ".json", {view.begin(), view.end()});
        });
    }
    return fail(ErrorCode::NotFound, "no moving session saw a final still, so there is nothing for " + path);
}

Expected<void> run(BenchFlags& flags) {
    int total = 0;
    for (const int count : flags.sessions) total += count;
    if (total == 0)
        return fail(ErrorCode::InvalidArgument,
                    "nothing to do: give --moving, --idle, --slow or --never-ack");
    const auto from = flags.cloud.choose();
    if (!from) return passOn(from);
    const auto cloud = from->info();
    if (!cloud) return passOn(cloud);
    const auto start = orbitStart(flags.view, *cloud);
    if (!start) return passOn(start);
    flags.options.cloud = cloud->id;
    auto codecs = flags.codec.codecs();
    if (!codecs) return passOn(std::move(codecs));
    flags.options.codecs = std::move(*codecs);
    flags.options.start = *start;

    const auto results = runSessions(from->server, flags);
    const auto report = benchReport(flags.options, results);
    sayOn(stdout, "%s", flags.json ? (printJson(report) + "\n").c_str() : benchText(report).c_str());
    if (!flags.final.empty())
        if (auto ok = writeFinal(flags.final, results); !ok) return ok;
    for (const auto& group : report.at("groups"))
        if (group.at("failed") != 0)
            return fail(ErrorCode::Io, group.at("failed").dump() + " sessions failed: " +
                                           group.at("errors").front().get<std::string>());
    return {};
}

void addSessions(CLI::App& command, BenchFlags& flags) {
    const auto count = [&](const char* flag, Behaviour behaviour, const char* meaning) {
        command.add_option(flag, flags.sessions[std::size_t(behaviour)], meaning)
            ->type_name("N")
            ->check(CLI::Range(0, 10000))
            ->group("Sessions");
    };
    count("--moving", Behaviour::Moving,
          "Number of sessions that circle the cloud and acknowledge every frame");
    count("--idle", Behaviour::Idle, "Number of sessions that look at one view and wait");
    count("--slow", Behaviour::Slow, "Number of sessions that move, but read only --slow-bytes per second");
    count("--never-ack", Behaviour::NeverAck, "Number of sessions that move, but acknowledge nothing");
}

void addNumbers(CLI::App& command, BenchOptions& options) {
    const auto number = [&](const char* flag, auto& value, const char* type, double least, double most,
                            const char* meaning) {
        command.add_option(flag, value, meaning)->type_name(type)->check(CLI::Range(least, most));
    };
    number("--seconds", options.seconds, "SECONDS", 0.1, 86400, "How long to measure (10)");
    number("--warm-up", options.warmUp, "SECONDS", 0, 3600, "Seconds of moving beforehand, not measured (1)");
    number("--views", options.viewsPerSecond, "N", 0.1, 1000,
           "Views per second that a moving session sends (60)");
    number("--fps", options.fps, "N", 1, 240, "Frames per second that sessions ask the server for (30)");
    number("--degrees", options.degreesPerSecond, "N", 0, 360,
           "Degrees per second that moving sessions travel around the cloud (30)");
    number("--slow-bytes", options.slowBytesPerSecond, "N", 1000, 1e9,
           "Bytes per second that --slow sessions read (50000)");
    number("--wake", options.wake, "SECONDS", 0, 86400,
           "Seconds after the start at which idle sessions send one view");
}

}  // namespace

void addBench(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<BenchFlags>();
    auto& command = *app.add_subcommand("bench", "Open many sessions at once and measure what they see");
    flags->cloud.addTo(command);
    addSessions(command, *flags);
    addNumbers(command, flags->options);
    flags->codec.addTo(command);
    command
        .add_option(
            "--final", flags->final,
            "Write a moving session's final still to this file, and the view that it shows to FILE.json")
        ->type_name("FILE.jpg");
    command.add_flag("--json", flags->json, "Print one JSON object");
    flags->view.addTo(command);
    command.footer(
        "All sessions first see their view's final still; then the clock starts. The time of a frame is that "
        "since\n"
        "the view which it shows was sent. Example:\n"
        "  scancast-client bench http://127.0.0.1:8080/ town --moving 8 --slow 1 --seconds 10");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
