// How much memory and disk an ingest needs, and what of them there is. Pipeline: before anything is read. Pure functions of options and
// what the system says.
#pragma once

#include <cstdint>
#include <filesystem>

#include "renderer/cloud/build/ingest.hpp"

namespace scancast {

/// What is left beside the program and the chunks being worked on may hold points that wait.
struct MemoryShares {
    int lanes = 1;
    std::uint64_t workspace = 0;
};

MemoryShares shareMemory(std::uint64_t limit, int threads, const OctreeShape& shape);

/// Bytes. InvalidArgument for too few.
Expected<std::uint64_t> memoryLimit(const IngestOptions& options);

/// The one that a file is in.
std::filesystem::path folderOf(const std::filesystem::path& file);

/// Refuses before reading what could not be finished. Estimates from above: a point is 22 bytes in the file
/// at most, and waits in at most 28 bytes (staged and divided, minus what has been given back meanwhile). Errors: ResourceLimit.
Expected<void> checkDisk(const DiskNeeds& needs, const std::filesystem::path& outputFolder,
                         const std::filesystem::path& scratch);

}  // namespace scancast
