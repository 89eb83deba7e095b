#include "renderer/cloud/distance/epoch_distance.hpp"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <new>

#include "files/machine.hpp"
#include "renderer/cloud/build/plan/ingest_room.hpp"
#include "renderer/cloud/distance/distance_column.hpp"
#include "renderer/cloud/distance/epoch_pair.hpp"
#include "renderer/cloud/distance/measured_copy.hpp"
#include "renderer/cloud/file/cloud_file_writer.hpp"

namespace scancast {

namespace {

using Clock = std::chrono::steady_clock;

/// Bytes: program and indices; what a thread has of a leaf and its trees; what a point takes until its chunk is written.
constexpr std::uint64_t fixedBytes = std::uint64_t(64) << 20, laneBytes = std::uint64_t(16) << 20,
                        pointBytes = 96;
constexpr std::uint64_t leastTrees = std::uint64_t(32) << 20, mostChunkPoints = 4'000'000;

Expected<void> checkOptions(const DistanceOptions& options) {
    if (!(options.most > 0) || !std::isfinite(float(options.most)))
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("max is a distance above 0, in the unit of the file, not {}", options.most),
                    "max");
    for (int a = 0; a < 3; ++a)
        if (!std::isfinite(options.shift[a]))
            return fail(ErrorCode::InvalidArgument, "shift is three finite numbers, in the unit of the file",
                        "shift");
    return {};
}

struct Shares {
    int threads = 1;
    std::uint64_t trees = 0, chunkPoints = 0;
};

Expected<Shares> shareLimit(const DistanceOptions& options, const CloudFile& after) {
    const std::uint64_t limit = options.memoryLimit > 0 ? options.memoryLimit : machineMemory() / 2;
    if (limit < leastDistanceMemory)
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format("A memory limit of {} MB is too little; at least 256M are needed", limit >> 20),
            "memory-limit");
    std::uint64_t row = 0;
    for (const ValuePlane& plane : after.planes()) row += bytesOf(plane.type);
    Shares shares;
    const int threads = coresOf(options.threads);
    shares.threads = int(std::clamp<std::uint64_t>(limit / 4 / laneBytes, 1, std::uint64_t(threads)));
    shares.chunkPoints = std::min(mostChunkPoints, limit / 4 / (pointBytes + 2 * row));
    const std::uint64_t used =
        fixedBytes + std::uint64_t(shares.threads) * laneBytes + shares.chunkPoints * (pointBytes + 2 * row);
    shares.trees = std::max(leastTrees, limit > used ? limit - used : 0);
    return shares;
}

Expected<DistanceReport> measure(const DistanceOptions& options, const ProgressSink& progress,
                                 const std::stop_token& stop) {
    const auto start = Clock::now();
    if (auto ok = checkOptions(options); !ok) return passOn(ok);
    auto pair = openEpochs(options);
    if (!pair) return passOn(pair);
    const CloudFile& after = *pair->after;
    if (auto ok = checkColumnName(options.name, after.facts()); !ok) return passOn(ok);
    const auto shares = shareLimit(options, after);
    if (!shares) return passOn(shares);
    const auto folder = folderOf(options.output);
    const DiskNeeds needs{.file = after.bytes() + after.facts().points * 2 * sizeof(float)};
    if (auto ok = checkDisk(needs, folder, folder); !ok) return passOn(ok);
    auto writer = CloudFileWriter::create(options.output);
    if (!writer) return passOn(writer);

    const EarlierPoints earlier(pair->before, options.shift, shares->trees);
    const Column column = distanceColumn(options, pair->before->facts(), pair->unit);
    MeasuredCopy copy(after, earlier,
                      {.column = column, .most = options.most, .chunkPoints = shares->chunkPoints}, **writer);
    tbb::task_arena arena(shares->threads);
    const auto facts = arena.execute([&] { return copy.write(progress, stop); });
    if (!facts) return passOn(facts);

    DistanceReport report;
    report.column = copy.column();
    report.points = facts->points;
    report.beyond = copy.summary().beyond();
    report.median = copy.summary().median();
    report.unit = pair->unit;
    report.fileBytes = (*writer)->bytesWritten();
    report.remarks = std::move(pair->remarks);
    report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return report;
}

}  // namespace

Expected<DistanceReport> measureDistance(const DistanceOptions& options, const ProgressSink& progress,
                                         const std::stop_token& stop) {
    try {
        return measure(options, progress, stop);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit,
                    "The machine has not enough memory; give a smaller --memory-limit");
    } catch (const std::exception& e) {
        return fail(ErrorCode::Internal, fmt::format("The distances could not be measured: {}", e.what()));
    }
}

}  // namespace scancast
