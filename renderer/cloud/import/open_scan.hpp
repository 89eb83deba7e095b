// Opens any scan file by what it is: LAS and text in process, LAZ, Potree octrees, PLY and PCD through an
// importer process (decision 3: third-party parsers never run inside the server). Pipeline: file → **import**
// → octree.
#pragma once

#include <filesystem>
#include <memory>

#include "renderer/cloud/import/scan_input.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct ImportOptions {
    /// Where scancast-import-* programs are; empty = beside the running program, then on PATH.
    std::filesystem::path importerDirectory;
    std::uint64_t importerMemoryLimit = std::uint64_t(16) << 30;  ///< bytes of address space
    int importerTimeoutSeconds = 600;                             ///< without any new byte
    /// Keep what does not fit the sample (GPS time, returns, extra bytes, spare text columns) as
    /// ScanHeader::columns.
    bool keepAttributes = false;
};

/// Reads from what is open there, also when somebody else does. Errors name the file, the byte offset where there is one,
/// and the reason: Io, Unsupported (with the formats that are), Malformed, Truncated, Empty, Importer.
Expected<std::unique_ptr<PointSource>> openScan(const ScanInput& input, const ImportOptions& options = {});
/// The same, and the errors of ScanInput::open().
Expected<std::unique_ptr<PointSource>> openScan(const std::filesystem::path& path,
                                                const ImportOptions& options = {});

}  // namespace scancast
