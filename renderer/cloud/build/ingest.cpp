#include "renderer/cloud/build/ingest.hpp"

#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <new>

#include "files/machine.hpp"
#include "renderer/cloud/build/cloud_builder.hpp"
#include "renderer/cloud/build/many_scans.hpp"
#include "renderer/cloud/build/nodes/inner_columns.hpp"
#include "renderer/cloud/build/plan/finish_file.hpp"
#include "renderer/cloud/build/plan/ingest_room.hpp"
#include "renderer/cloud/build/revision.hpp"
#include "renderer/cloud/exact_scan.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

Expected<IngestReport> build(std::vector<std::unique_ptr<PointSource>> sources, const IngestOptions& options,
                             const ProgressSink& progress, const std::stop_token& stop) {
    const auto start = std::chrono::steady_clock::now();
    const auto limit = memoryLimit(options);
    if (!limit) return passOn(limit);
    const bool onOneGrid = shareOneGrid(sources);
    auto source = manyScans(std::move(sources), options.names);
    if (!source) return passOn(source);
    if (options.shape.exact) *source = exactScan(std::move(*source), onOneGrid);

    const fs::path outputFolder = folderOf(options.output);
    const fs::path scratch = scratchFolder(options);
    const int threads = coresOf(options.threads);
    const MemoryShares memory = shareMemory(*limit, threads, options.shape);
    if (auto needs = diskNeeds((*source)->header(), options)) {
        // They wait until the points are read.
        const std::uint64_t photos = options.photos ? bytesOf((*source)->photos()) : 0;
        needs->file += photos;
        needs->scratch += photos;
        if (auto ok = checkDisk(*needs, outputFolder, scratch); !ok) return passOn(ok);
    }

    auto file = CloudFileWriter::create(options.output, options.readers);
    if (!file) return passOn(file);
    Workspace workspace(memory.workspace, scratch);
    auto built = buildFrom(
        **source, options.shape,
        {.workspace = workspace, .file = file->get(), .threads = options.threads, .lanes = memory.lanes},
        progress, stop);
    if (!built) return passOn(built);
    auto report = finishFile(std::move(*built), options, **file, progress, stop);
    if (!report) return report;
    report->scratchBytes = workspace.mostOnDisk();
    report->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace

Expected<IngestReport> finishFile(BuiltCloud built, const IngestOptions& options, CloudFileWriter& file,
                                  const ProgressSink& progress, const std::stop_token& stop) {
    IngestReport report;
    report.facts = std::move(built.facts);
    report.facts.title = options.title.empty() ? options.output.stem().string() : options.title;
    report.facts.attribution = options.attribution;
    report.facts.recorded = options.recorded;
    report.facts.mirrors = options.mirrors;
    const auto limit = memoryLimit(options);
    if (!limit) return passOn(limit);
    const InnerColumnsRoom room{.threads = options.threads, .memory = *limit / 4};
    if (auto ok = addInnerColumns(report.facts, built.octree, file, room, progress, stop); !ok)
        return passOn(ok);
    report.facts.revision = revisionOf(report.facts, built.octree);
    if (auto ok = file.finish(report.facts, built.octree.nodes, built.octree.planes, stop); !ok)
        return passOn(ok);

    const Node& last = built.octree.nodes.back().node;
    report.nodes = built.octree.nodes.size();
    report.samples = last.firstSample + last.sampleCount;
    report.fileBytes = file.bytesWritten();
    return report;
}

Expected<IngestReport> ingest(std::vector<std::unique_ptr<PointSource>> sources, const IngestOptions& options,
                              const ProgressSink& progress, std::stop_token stop) {
    try {
        return build(std::move(sources), options, progress, stop);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit,
                    "The machine has not enough memory; give a smaller --memory-limit.");
    } catch (const std::exception& e) {
        return fail(ErrorCode::Internal, fmt::format("The cloud could not be built: {}.", e.what()));
    }
}

}  // namespace scancast
