#include "renderer/cloud/build/ingest.hpp"

#include <spdlog/fmt/fmt.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <new>
#include <thread>

#include "files/machine.hpp"
#include "renderer/cloud/build/chunks/staging.hpp"
#include "renderer/cloud/build/cloud_builder.hpp"
#include "renderer/cloud/build/many_scans.hpp"
#include "renderer/cloud/build/revision.hpp"
#include "renderer/cloud/exact_scan.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

/// Bytes a point that the pieces of the work take; measured, rounded up.
constexpr std::uint64_t laneBytes = 160, laneBytesWithSurfels = 270;
constexpr std::uint64_t stagedBytes = 20, chunkBytes = 24, fileBytes = 22, curvatureBytes = 5,
                        exactBytes = 13;
/// Program, counting grid, readers.
constexpr std::uint64_t fixedBytes = std::uint64_t(160) << 20;

struct MemoryShares {
    int lanes = 1;
    std::uint64_t workspace = 0;
};

/// What is left beside the program and the chunks being worked on may hold points that wait.
MemoryShares shareMemory(std::uint64_t limit, int threads, const OctreeShape& shape) {
    const std::uint64_t lane = shape.chunkPoints * (shape.surfels ? laneBytesWithSurfels : laneBytes);
    MemoryShares shares;
    shares.lanes = int(std::clamp<std::uint64_t>(limit / 2 / std::max<std::uint64_t>(lane, 1), 1,
                                                 std::uint64_t(std::max(threads, 1))));
    const std::uint64_t used = fixedBytes + std::uint64_t(shares.lanes) * lane;
    shares.workspace = limit > used ? limit - used : 0;
    return shares;
}

std::string gigabytes(std::uint64_t bytes) {
    return fmt::format("{:.1f} GB", double(bytes) / 1e9);
}

std::optional<std::uint64_t> freeBytes(const fs::path& folder) {
    struct statvfs found {};
    if (::statvfs(folder.c_str(), &found) != 0) return std::nullopt;
    return std::uint64_t(found.f_bavail) * found.f_frsize;
}

bool sameDisk(const fs::path& a, const fs::path& b) {
    struct statvfs first {
    }, second{};
    return ::statvfs(a.c_str(), &first) == 0 && ::statvfs(b.c_str(), &second) == 0 &&
           first.f_fsid == second.f_fsid;
}

Expected<void> checkRoom(const fs::path& folder, std::uint64_t needed, std::string_view what) {
    const auto there = freeBytes(folder);
    if (!there || *there >= needed) return {};
    return fail(
        ErrorCode::ResourceLimit,
        fmt::format("{} needs about {} in {}, where {} are free; free some space or choose another folder.",
                    what, gigabytes(needed), folder.string(), gigabytes(*there)));
}

/// Refuses before reading what could not be finished. Estimates from above: a point is 22 bytes in the file
/// at most, and waits in at most 28 bytes (staged and divided, minus what has been given back meanwhile).
fs::path folderOf(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

Expected<void> checkDisk(const DiskNeeds& needs, const fs::path& outputFolder, const fs::path& scratch) {
    if (sameDisk(outputFolder, scratch))
        return checkRoom(outputFolder, needs.file + needs.scratch, "The cloud file with its temporary files");
    if (auto ok = checkRoom(outputFolder, needs.file, "The cloud file"); !ok) return ok;
    return checkRoom(scratch, needs.scratch, "Building the cloud");
}

Expected<std::uint64_t> memoryLimit(const IngestOptions& options) {
    const std::uint64_t limit = options.memoryLimit > 0 ? options.memoryLimit : machineMemory() / 2;
    if (limit >= leastIngestMemory) return limit;
    return fail(ErrorCode::InvalidArgument,
                fmt::format("A memory limit of {} MB is too little; at least 512M are needed.", limit >> 20),
                "memory-limit");
}

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
    const int threads = options.threads > 0 ? options.threads : machineCores();
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
    IngestReport report;
    report.facts = std::move(built->facts);
    report.facts.title = options.title.empty() ? options.output.stem().string() : options.title;
    report.facts.attribution = options.attribution;
    report.facts.recorded = options.recorded;
    report.facts.mirrors = options.mirrors;
    report.facts.revision = revisionOf(report.facts, built->octree);
    if (auto ok = (*file)->finish(report.facts, built->octree.nodes, built->octree.planes, stop); !ok)
        return passOn(ok);

    const Node& last = built->octree.nodes.back().node;
    report.nodes = built->octree.nodes.size();
    report.samples = last.firstSample + last.sampleCount;
    report.fileBytes = (*file)->bytesWritten();
    report.scratchBytes = workspace.mostOnDisk();
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace

std::filesystem::path scratchFolder(const IngestOptions& options) {
    return options.scratch.empty() ? folderOf(options.output) : options.scratch;
}

std::optional<DiskNeeds> diskNeeds(const ScanHeader& header, const IngestOptions& options) {
    if (!header.points) return std::nullopt;
    const std::uint64_t limit = options.memoryLimit > 0 ? options.memoryLimit : machineMemory() / 2;
    const int threads = options.threads > 0 ? options.threads : machineCores();
    const std::uint64_t inMemory = shareMemory(limit, threads, options.shape).workspace;
    const std::uint64_t row = stagedRowBytes(header);
    const std::uint64_t beside =
        (options.shape.curvatures() ? curvatureBytes : 0) + (options.shape.exact ? exactBytes : 0);
    const std::uint64_t waiting = *header.points * (std::max(stagedBytes, chunkBytes) + 8 + row);
    return DiskNeeds{.file = *header.points * (fileBytes + beside + row),
                     .scratch = waiting > inMemory ? waiting - inMemory : 0};
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
