// Ingests scans by as many ranks as mpirun started, with chunks so small that a small scan has many, and at rank 0 by one process, too:
// the files have to be the same bytes. That is the oracle: one process has nobody to share with.
//
//   mpirun -n N ingest_by_ranks FOLDER SCAN…
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "files/program_start.hpp"
#include "ranks/ingest/rank_ingest.hpp"
#include "ranks/mpi/session.hpp"
#include "renderer/cloud/import/open_scan.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

struct Case {
    const char* name;
    OctreeShape shape;
    bool keep = false;
    std::uint64_t memory = std::uint64_t(2) << 30;
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
    return {{"points alone", plain},
            {"with attributes", plain, true},
            {"surfels whose sides are found", surfels, true},
            {"surfels, on disk", surfels, false, leastIngestMemory},
            {"exactly", exact, true},
            {"surfels that look up", up},
            {"surfels without sides", scan},
            {"one chunk", whole}};
}

std::string contentOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

Expected<std::vector<std::unique_ptr<PointSource>>> openAll(const std::vector<std::string>& files,
                                                            const Case& how) {
    ImportOptions import;
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

Expected<void> compare(const Case& how, const fs::path& folder, const std::vector<std::string>& files,
                       const MpiSession& session, const Communicator& world) {
    IngestOptions options;
    options.names = files;
    options.shape = how.shape;
    options.memoryLimit = how.memory;
    options.threads = 1;
    options.title = "A scan";
    options.output = folder / fmt::format("ranks{}.scan", world.size());
    std::stop_source work;
    Alarm alarm(world, work);
    auto sources = world.agree(openAll(files, how));
    if (!sources) return passOn(sources);
    const auto together =
        ingestTogether(std::move(*sources), options,
                       {.ranks = world, .alarm = alarm, .onThisMachine = session.ranksOnThisMachine()}, {},
                       work.get_token());
    if (!together) return passOn(together);
    if (!world.isFirst()) return {};
    IngestOptions alone = options;
    alone.output = folder / fmt::format("alone{}.scan", world.size());
    auto again = openAll(files, how);
    if (!again) return passOn(again);
    const auto report = ingest(std::move(*again), alone);
    if (!report) return passOn(report);
    const bool same = contentOf(options.output) == contentOf(alone.output);
    fmt::print("{}: {} of {} nodes\n", how.name, same ? "the same bytes" : "DIFFERENT", report->nodes);
    if (same && report->facts.points == together->facts.points) return {};
    return fail(ErrorCode::Internal, "The ranks' file is not the one that one process writes.");
}

Expected<void> run(const fs::path& folder, const std::vector<std::string>& files) {
    auto session = MpiSession::start({});
    if (!session) return passOn(session);
    for (const Case& how : cases()) {
        // What only rank 0 finds out, the others hear.
        const auto done = compare(how, folder, files, **session, (*session)->world());
        if (auto all = (*session)->world().agree(done); !all) return all;
    }
    return {};
}

}  // namespace
}  // namespace scancast

int main(int argc, char** argv) {
    scancast::startProgram();
    if (argc < 3) return 2;
    const auto done = scancast::run(argv[1], std::vector<std::string>(argv + 2, argv + argc));
    if (!done) fmt::print(stderr, "{}\n", done.error().message);
    return done ? 0 : 1;
}
