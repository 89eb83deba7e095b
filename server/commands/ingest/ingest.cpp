// `scancast ingest`: any number of scans become one cloud file, out of core.
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "server/commands/command.hpp"
#include "server/commands/ingest/ingest_flags.hpp"
#include "server/commands/scans/found_scans.hpp"
#include "server/terminal/interruption.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Expected<void> runIngest(const IngestArguments& arguments) {
    const auto start = Clock::now();
    returnMemoryOfChunks();
    const auto found = findScans(arguments.inputs, {.cloudFiles = false});
    if (!found) return passOn(found);
    auto options = ingestOptions(arguments, found->files());
    if (!options) return passOn(options);
    if (!arguments.quiet) tellLeftOut(*found, arguments.verbose);
    const auto look = lookOf(arguments);
    if (!look) return passOn(look);
    auto import = importOptions(arguments, *options);
    if (!import) return passOn(import);
    const Interruption interruption;
    import->stop = interruption.token();
    auto sources = openAll(found->files(), *options, *import);
    if (!sources) return withRecovery(sources.error(), arguments.recover);
    if (!arguments.quiet) tellNeeds(*sources, *options);
    ProgressBar bar(stderr, arguments.quiet ? ProgressBar::Style::Quiet : ProgressBar::Style::Automatic);
    const auto report = ingest(std::move(*sources), *options, bar.sink(), interruption.token());
    bar.clear();
    const double seconds = secondsSince(start);
    if (!report && report.error().code == ErrorCode::Cancelled)
        return fail(ErrorCode::Cancelled, "Interrupted; no cloud file was left behind.");
    if (!report) return withRecovery(report.error(), arguments.recover);
    if (auto ok = keepLookOf(arguments, *look); !ok) return ok;
    if (arguments.quiet) return {};
    tellIngested(arguments, *report, seconds);
    return {};
}

constexpr const char* ingestExamples =
    "Examples:\n"
    "  scancast ingest town.las -o town.scan\n"
    "  scancast ingest flight/ -o flight.scan --memory-limit 4G --orient up\n"
    "  scancast ingest 'flights/2024-*/**/*.laz' -o all.scan\n"
    "  scancast generate town --points 1G --format las14 -o - | scancast ingest - -o big.scan\n"
    "  scancast serve town.scan          # opens at once, whatever its size\n";

}  // namespace

void addIngest(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<IngestArguments>();
    CLI::App* command =
        app.add_subcommand("ingest", "Turn scans into a cloud file, which opens instantly at any size");
    addIngestFlags(*command, *arguments, memoryOfMaking, threadsOfMaking);
    command->footer(ingestExamples);
    command->callback([arguments, &exitCode] {
        const auto done = runIngest(*arguments);
        exitCode = done ? 0 : 1;
        if (!done) tell("scancast ingest: {}\n", done.error().message);
    });
}

}  // namespace scancast
