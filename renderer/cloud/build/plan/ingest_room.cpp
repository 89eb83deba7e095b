#include "renderer/cloud/build/plan/ingest_room.hpp"

#include <spdlog/fmt/fmt.h>
#include <sys/statvfs.h>

#include <algorithm>

#include "files/machine.hpp"
#include "renderer/cloud/build/chunks/staging.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

/// Bytes a point that the pieces of the work take; measured, rounded up.
constexpr std::uint64_t laneBytes = 160, laneBytesWithSurfels = 270;
constexpr std::uint64_t stagedBytes = 20, chunkBytes = 24, fileBytes = 22, curvatureBytes = 5,
                        exactBytes = 13;
/// Program, counting grid, readers.
constexpr std::uint64_t fixedBytes = std::uint64_t(160) << 20;

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

}  // namespace

MemoryShares shareMemory(std::uint64_t limit, int threads, const OctreeShape& shape) {
    const std::uint64_t lane = shape.chunkPoints * (shape.surfels ? laneBytesWithSurfels : laneBytes);
    MemoryShares shares;
    shares.lanes = int(std::clamp<std::uint64_t>(limit / 2 / std::max<std::uint64_t>(lane, 1), 1,
                                                 std::uint64_t(std::max(threads, 1))));
    const std::uint64_t used = fixedBytes + std::uint64_t(shares.lanes) * lane;
    shares.workspace = limit > used ? limit - used : 0;
    return shares;
}

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

std::filesystem::path scratchFolder(const IngestOptions& options) {
    return options.scratch.empty() ? folderOf(options.output) : options.scratch;
}

std::optional<DiskNeeds> diskNeeds(const ScanHeader& header, const IngestOptions& options) {
    if (!header.points) return std::nullopt;
    const std::uint64_t limit = options.memoryLimit > 0 ? options.memoryLimit : machineMemory() / 2;
    const int threads = coresOf(options.threads);
    const std::uint64_t inMemory = shareMemory(limit, threads, options.shape).workspace;
    const std::uint64_t row = stagedRowBytes(header);
    const std::uint64_t beside =
        (options.shape.curvatures() ? curvatureBytes : 0) + (options.shape.exact ? exactBytes : 0);
    const std::uint64_t waiting = *header.points * (std::max(stagedBytes, chunkBytes) + 8 + row);
    return DiskNeeds{.file = *header.points * (fileBytes + beside + row),
                     .scratch = waiting > inMemory ? waiting - inMemory : 0};
}

}  // namespace scancast
