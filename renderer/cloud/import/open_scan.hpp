// Opens any scan file by what it is: LAS and text in process, LAZ, E57, octrees of EPT and Potree, PLY and PCD through an
// importer process (decision 3: third-party parsers never run inside the server). Pipeline: file → **import**
// → octree.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>

#include "renderer/cloud/import/assumed_crs.hpp"
#include "renderer/cloud/import/scan_input.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// How importer programs are shut in (decision 18).
enum class ImporterSandbox : std::uint8_t {
    Auto,     ///< by what the machine has
    Require,  ///< completely, or no importer is started
    Off,      ///< not at all; limits hold all the same
};
std::string_view name(ImporterSandbox sandbox);

struct ImportOptions {
    /// Where scancast-import-* programs are; empty = beside the running program, then on PATH.
    std::filesystem::path importerDirectory{};
    std::uint64_t importerMemoryLimit = std::uint64_t(16) << 30;  ///< bytes of address space; 0 = none
    std::uint64_t importerProcessorSeconds = 7200;                ///< 0 = none
    int importerSilenceSeconds = 60;  ///< without a byte sent, or read of the file
    ImporterSandbox importerSandbox = ImporterSandbox::Auto;
    std::stop_token stop{};  ///< ends an importer that is waited for
    /// Keep what does not fit the sample (GPS time, returns, extra bytes, spare text columns) as
    /// ScanHeader::columns.
    bool keepAttributes = false;
    /// With keepAttributes: and colours of 16 bits, as columns (exact_columns.hpp). LAS, and what importers take apart to
    /// its records.
    bool exact = false;
    /// Of a scan that ends too early, read what is whole; a note says how much is lost. Not of every format.
    bool recover = false;
    /// What only all points of a file tell - whether colours have 8 or 16 bits - somebody looks for in parts (PointSource::wantsToBeSeen),
    /// where the first places do not tell. Else it is looked for when the file is opened.
    bool looksInParts = false;
    /// Folder of the unnamed temporary files in which photos that scans bring along wait for the cloud; nullopt: they are described, and
    /// their bytes passed over.
    std::optional<std::filesystem::path> photos{};
    /// Taken for the scan's coordinate reference system, whatever it says.
    std::optional<AssumedCrs> assumeCrs{};
};

/// Reads from what is open there, also when somebody else does. Errors name the file, the byte offset where there is one,
/// and the reason: Io, Unsupported (with the formats that are), Malformed, Truncated, Empty, Importer.
Expected<std::unique_ptr<PointSource>> openScan(const ScanInput& input, const ImportOptions& options = {});
/// Whether openScan() would start an importer for it. False for what cannot be read: openScan() says why.
bool needsImporter(const ScanInput& input);
/// The same, and the errors of ScanInput::open().
Expected<std::unique_ptr<PointSource>> openScan(const std::filesystem::path& path,
                                                const ImportOptions& options = {});

}  // namespace scancast
