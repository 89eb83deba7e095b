// Ingests scans by as many ranks as mpirun started, with chunks so small that a small scan has many, and at rank 0 by one process, too:
// the files have to be the same bytes, or the refusals the same sentences. That is the oracle: one process has nobody to share with.
//
//   mpirun -n N ingest_by_ranks FOLDER SCAN… [-- SCAN…]…     the first scans in every shape, others in some
//   mpirun -n N ingest_by_ranks FOLDER --stop-while-writing SCAN…
//
// The second says "writing" once rank 0 has begun to write the cloud file, and then rank 0 does nothing more until it is killed: whatever
// happens to the ranks meets a file that is being written.
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>
#include <vector>

#include "files/program_start.hpp"
#include "ranks/ingest/rank_ingest.hpp"
#include "ranks/mpi/session.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "server/terminal/interruption.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using Scans = std::vector<std::string>;

struct Case {
    const char* name;
    OctreeShape shape;
    bool keep = false;
    bool onDisk = false;  ///< whatever waits; and sent in many rounds, sorted by many threads
    bool ofAll = false;   ///< not of the first scans alone
};

std::vector<Case> cases() {
    OctreeShape plain{.leafPoints = 128, .chunkPoints = 1200};
    OctreeShape surfels = plain, exact = plain, up = plain, scan = plain, whole = plain;
    for (OctreeShape* const shape : {&surfels, &exact, &up, &scan, &whole}) shape->surfels = true;
    exact.exact = true;
    up.orientation = Orientation::Up;
    up.curvature = false;
    scan.orientation = Orientation::Scan;
    whole.chunkPoints = 1 << 20;
    return {{"points alone", plain, false, false, true},
            {"with attributes", plain, true},
            {"surfels whose sides are found", surfels},
            {"surfels, on disk", surfels, false, true},
            {"exactly, on disk", exact, true, true, true},
            {"surfels that look up", up},
            {"surfels without sides", scan},
            {"one chunk", whole}};
}

std::string contentOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

Expected<std::vector<std::unique_ptr<PointSource>>> openAll(const Scans& files, const Case& how,
                                                            bool looksInParts = false) {
    ImportOptions import;
    import.looksInParts = looksInParts;
    import.keepAttributes = how.keep;
    import.exact = how.shape.exact;
    std::vector<std::unique_ptr<PointSource>> sources;
    for (const std::string& file : files) {
        auto source = openScan(file, import);
        if (!source) return passOn(source);
        sources.push_back(std::move(*source));
    }
    return sources;
}

IngestOptions optionsFor(const Case& how, const Scans& files) {
    IngestOptions options;
    options.names = files;
    options.shape = how.shape;
    options.memoryLimit = std::uint64_t(2) << 30;
    options.threads = how.onDisk ? 3 : 1;
    options.title = "A scan";
    return options;
}

tl::unexpected<Error> different(const std::string& what) {
    return fail(ErrorCode::Internal, "By ranks it is not what one process makes: " + what);
}

/// Everything that a report says, but how long it took and where points waited.
Expected<void> sameReports(const IngestReport& together, const IngestReport& alone) {
    const auto told = [](const IngestReport& r) {
        return fmt::format("{} points, {} left out, {} nodes, {} samples, {} bytes, notes: {}",
                           r.facts.points, r.facts.droppedPoints, r.nodes, r.samples, r.fileBytes,
                           fmt::join(r.facts.notes, "; "));
    };
    if (told(together) == told(alone)) return {};
    return different(told(together) + " instead of " + told(alone));
}

Expected<void> compare(const Case& how, const fs::path& folder, const Scans& files, const MpiSession& session,
                       const Communicator& world) {
    IngestOptions options = optionsFor(how, files);
    options.output = folder / fmt::format("ranks{}.scan", world.size());
    std::stop_source work;
    Alarm alarm(world, work);
    auto sources = world.agree(openAll(files, how, true));
    if (!sources) return passOn(sources);
    RankRoom room{.ranks = world, .alarm = alarm, .onThisMachine = session.ranksOnThisMachine()};
    if (how.onDisk) room.mostWaiting = 0, room.mostInRound = 4096;
    const auto together = ingestTogether(std::move(*sources), options, room, {}, work.get_token());
    if (!world.isFirst()) return {};
    if (how.onDisk && together && together->scratchBytes == 0) return different("nothing was on disk");
    IngestOptions alone = options;
    alone.output = folder / fmt::format("alone{}.scan", world.size());
    auto again = openAll(files, how);
    if (!again) return passOn(again);
    const auto report = ingest(std::move(*again), alone);
    if (report.has_value() != together.has_value())
        return different(together ? report.error().message : together.error().message);
    if (!report) {
        if (report.error().message != together.error().message)
            return different(together.error().message + " instead of " + report.error().message);
        fmt::print("{}: the same refusal: {}\n", how.name, report.error().message);
        return {};
    }
    const bool same = contentOf(options.output) == contentOf(alone.output);
    fmt::print("{} of {}: {}, {} nodes\n", how.name, fs::path(files.back()).filename().string(),
               same ? "the same bytes" : "DIFFERENT", report->nodes);
    if (auto ok = sameReports(*together, *report); !ok) return ok;
    return same ? Expected<void>() : different("other bytes");
}

Expected<void> compareAll(const fs::path& folder, const std::vector<Scans>& groups) {
    auto session = MpiSession::start({});
    if (!session) return passOn(session);
    for (const Scans& files : groups)
        for (const Case& how : cases()) {
            if (&files != &groups.front() && !how.ofAll) continue;
            // What only rank 0 finds out, the others hear.
            const auto done = compare(how, folder, files, **session, (*session)->world());
            if (auto all = (*session)->world().agree(done); !all) return all;
        }
    return {};
}

Expected<void> stopWhileWriting(const fs::path& folder, const Scans& files) {
    const Interruption interruption;
    auto session = MpiSession::start(interruption.token());
    if (!session) return passOn(session);
    const Communicator& world = (*session)->world();
    std::stop_source work;
    const std::stop_callback stopWork(interruption.token(), [&] { work.request_stop(); });
    Alarm alarm(world, work);
    const Case how = cases().front();
    auto sources = world.agree(openAll(files, how));
    if (!sources) return passOn(sources);
    IngestOptions options = optionsFor(how, files);
    options.output = folder / "stopped.scan";
    const ProgressSink waiting = [](const Progress& progress) {
        if (progress.stage != "writing") return;
        fmt::print("writing\n");
        std::fflush(stdout);
        std::this_thread::sleep_for(std::chrono::minutes(2));
    };
    const RankRoom room{.ranks = world, .alarm = alarm, .onThisMachine = (*session)->ranksOnThisMachine()};
    const auto report = ingestTogether(std::move(*sources), options, room,
                                       world.isFirst() ? waiting : ProgressSink(), work.get_token());
    if (!report) return passOn(report);
    return {};
}

}  // namespace
}  // namespace scancast

int main(int argc, char** argv) {
    using namespace scancast;
    startProgram();
    if (argc < 3) return 2;
    const bool stops = std::string_view(argv[2]) == "--stop-while-writing";
    std::vector<Scans> groups(1);
    for (int i = stops ? 3 : 2; i < argc; ++i) {
        if (std::string_view(argv[i]) == "--")
            groups.emplace_back();
        else
            groups.back().push_back(argv[i]);
    }
    const auto done = stops ? stopWhileWriting(argv[1], groups.front()) : compareAll(argv[1], groups);
    if (!done) fmt::print(stderr, "{}\n", done.error().message);
    return done ? 0 : 1;
}
