// From scans to a cloud file, out of core: `scancast ingest` without the command line.
// Pipeline: import → staging → chunks → octree builder → **cloud file**. Called on any thread; uses a TBB
// arena of its own.
//
// Memory stays within IngestOptions::memoryLimit however large the cloud; what does not fit waits in unnamed
// temporary files, which vanish with the process, whatever ends it. The file's bytes depend on the points and
// on the options that shape the octree alone: neither on threads, nor on the memory limit, nor on the order
// of the points.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "files/unfinished_file.hpp"
#include "renderer/cloud/build/octree_shape.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

struct IngestOptions {
    std::filesystem::path output{};
    /// Folder for temporary files; empty = the output's.
    std::filesystem::path scratch{};
    Readers readers = Readers::AsUsual;     ///< of the output
    std::string title{};                    ///< empty = the output's stem
    std::string attribution{}, recorded{};  ///< as CloudFacts has them
    int threads = 0;                        ///< 0 = all cores
    std::uint64_t memoryLimit = 0;          ///< bytes; 0 = half of the machine's memory
    OctreeShape shape{};
    std::vector<Mirror> mirrors{};
    bool photos = true;                ///< there is to be room for those of the sources
    std::vector<std::string> names{};  ///< of the sources, in their order, for messages
};

struct IngestReport {
    CloudFacts facts;
    std::uint64_t nodes = 0, samples = 0;
    std::uint64_t fileBytes = 0;
    std::uint64_t scratchBytes = 0;  ///< most that temporary files held at once
    double seconds = 0;
};

/// The least that memoryLimit may be.
inline constexpr std::uint64_t leastIngestMemory = std::uint64_t(512) << 20;

/// For temporary files.
std::filesystem::path scratchFolder(const IngestOptions& options);

struct DiskNeeds {
    std::uint64_t file = 0, scratch = 0;  ///< bytes, estimated from above
};
/// Nothing where the scan does not say how many points it has.
std::optional<DiskNeeds> diskNeeds(const ScanHeader& header, const IngestOptions& options);

/// Reads all sources, one after the other, into one cloud. Errors: the sources' own; Empty; InvalidArgument
/// (limit too small, sources in different coordinate systems); ResourceLimit (disk too full: refused before
/// reading where the sources say how many points they have); Io; Cancelled. No output file is left by any of
/// them.
Expected<IngestReport> ingest(std::vector<std::unique_ptr<PointSource>> sources, const IngestOptions& options,
                              const ProgressSink& progress = {}, std::stop_token stop = {});

}  // namespace scancast
