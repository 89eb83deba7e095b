// `scancast-ranks ingest`: scans become one cloud file, by several ranks.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <exception>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>

#include "protocol/flags/exit_codes.hpp"
#include "ranks/commands.hpp"
#include "ranks/ingest/rank_ingest.hpp"
#include "ranks/mpi/session.hpp"
#include "server/commands/ingest/ingest_flags.hpp"
#include "server/commands/scans/found_scans.hpp"
#include "server/terminal/interruption.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

using IngestClock = std::chrono::steady_clock;

/// What one rank reads, and how.
struct Prepared {
    IngestOptions options;
    nlohmann::json look;
    std::vector<std::unique_ptr<PointSource>> sources;
};

Expected<Prepared> prepare(IngestArguments arguments, MpiSession& session, const std::stop_token& stop) {
    const bool speaks = session.world().isFirst() && !arguments.quiet;
    // What has the output's name on other machines is not in the way.
    if (!session.world().isFirst()) arguments.force = true;
    const auto found = findScans(arguments.inputs, {.cloudFiles = false});
    if (!found) return passOn(found);
    for (const std::string& file : found->files())
        if (file == "-")
            return fail(ErrorCode::InvalidArgument,
                        "Several ranks cannot share standard input; save the scan to a file that all of them "
                        "can read.");
    auto options = ingestOptions(arguments, found->files());
    if (!options) return passOn(options);
    if (speaks) tellLeftOut(*found, arguments.verbose);
    auto look = lookOf(arguments);
    if (!look) return passOn(look);
    auto import = importOptions(arguments, *options);
    if (!import) return passOn(import);
    import->stop = stop;
    import->looksInParts = true;
    auto sources = openAll(found->files(), *options, *import);
    if (!sources) return passOn(sources);
    if (speaks) tellNeeds(*sources, *options);
    return Prepared{withOwnPart(std::move(*options), session.ranksOnThisMachine()), std::move(*look),
                    std::move(*sources)};
}

/// What only some ranks have met is told with where, since elsewhere everything looks right.
Expected<Prepared> agreeWithPlace(Expected<Prepared> mine, const Communicator& world) {
    std::uint64_t failed = !mine;
    if (auto ok = world.sum(std::span(&failed, 1)); !ok) return passOn(ok);
    if (!mine && mine.error().code != ErrorCode::Cancelled && failed < unsigned(world.size())) {
        std::array<char, 256> machine{};
        (void)::gethostname(machine.data(), machine.size() - 1);
        mine.error().message = fmt::format("Rank {} of {}, on {}: {}", world.rank(), world.size(),
                                           machine.data(), mine.error().message);
    }
    return world.agree(std::move(mine));
}

/// All ranks. What one throws nobody waits for: it ends them all.
Expected<IngestReport> ingestByRanks(const IngestArguments& arguments, MpiSession& session,
                                     const std::stop_token& interrupted, ProgressBar& bar,
                                     nlohmann::json& look) try {
    const Communicator& world = session.world();
    std::stop_source work;
    const std::stop_callback stopWork(interrupted, [&] { work.request_stop(); });
    Alarm alarm(world, work);
    auto prepared = agreeWithPlace(prepare(arguments, session, work.get_token()), world);
    if (!prepared) return passOn(prepared);
    look = std::move(prepared->look);
    return ingestTogether(std::move(prepared->sources), prepared->options,
                          {.ranks = world, .alarm = alarm, .onThisMachine = session.ranksOnThisMachine()},
                          world.isFirst() ? bar.sink() : ProgressSink(), work.get_token());
} catch (const std::bad_alloc&) {
    MpiSession::abortAll(
        "scancast-ranks ingest: A machine has not enough memory; give a smaller --memory-limit, which is "
        "each rank's.");
} catch (const std::exception& e) {
    MpiSession::abortAll(std::string("scancast-ranks ingest: The cloud could not be built: ") + e.what() +
                         ".");
}

/// As people are told.
Error readable(Error error, bool recover) {
    if (error.code == ErrorCode::Cancelled)
        return {ErrorCode::Cancelled, "Interrupted; no cloud file was left behind.", {}};
    return withRecovery(std::move(error), recover).value();
}

int failed(const Error& error) {
    tell("scancast-ranks ingest: {}\n", error.message);
    return exitFailed;
}

/// What the program exits with. One rank says why, while the others are still there: when the first is gone, mpirun ends them all.
int runRanksIngest(const IngestArguments& arguments) {
    const auto start = IngestClock::now();
    returnMemoryOfChunks();
    const Interruption interruption;  // before MPI has threads
    auto session = MpiSession::start(interruption.token());
    if (!session) return failed(session.error());
    const bool isTeller = (*session)->world().isFirst();
    ProgressBar bar(stderr,
                    arguments.quiet || !isTeller ? ProgressBar::Style::Quiet : ProgressBar::Style::Automatic);
    nlohmann::json look;
    const auto report = ingestByRanks(arguments, **session, interruption.token(), bar, look);
    bar.clear();
    if (!report && isTeller) failed(readable(report.error(), arguments.recover));
    session->reset();  // what is left is rank 0's alone
    if (!report) return exitFailed;
    if (!isTeller) return 0;
    const double seconds = std::chrono::duration<double>(IngestClock::now() - start).count();
    if (const auto ok = keepLookOf(arguments, look); !ok) return failed(ok.error());
    if (!arguments.quiet) tellIngested(arguments, *report, seconds);
    return 0;
}

constexpr const char* ranksIngestExamples =
    "Every rank needs all scans under the same names, on a file system that the machines share; the cloud "
    "file, and how it is\n"
    "shown at first, are rank 0's to write. It is the same file, byte for byte, that scancast ingest writes, "
    "with any number of\n"
    "ranks. docs/scaling.md says when that is worth it.\n\n"
    "Examples:\n"
    "  mpirun -n 4 --bind-to none scancast-ranks ingest flight/ -o flight.scan\n"
    "  mpirun --hostfile machines -N 1 --bind-to none scancast-ranks ingest town.las -o town.scan --scratch "
    "/var/tmp\n";

}  // namespace

void addRanksIngest(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<IngestArguments>();
    CLI::App* command =
        app.add_subcommand("ingest", "Turn scans into a cloud file, by several ranks together");
    addIngestFlags(*command, *arguments,
                   "Memory for each rank to stay within, such as 2G. Default: half of its machine's, divided "
                   "by the ranks there. "
                   "The file is the same whatever the limit",
                   "Number of threads of each rank; 0 = the cores of its machine, divided by the ranks "
                   "there. The file is the "
                   "same whatever the number");
    command->footer(ranksIngestExamples);
    command->get_option("inputs")->description(
        "Scans, folders of them, or patterns such as 'flight/*.laz', all merged into one cloud");
    command->callback([arguments, &exitCode] { exitCode = runRanksIngest(*arguments); });
}

}  // namespace scancast
