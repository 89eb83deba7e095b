// Scans that are shown as they are, without ingest: what opens them for commands and for the loader, with a look. Waits for what is read.
// Free functions; any thread. Place: bytes → **native cloud** → residency.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/folder_reader.hpp"
#include "files/random_reader.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/import/assumed_crs.hpp"
#include "renderer/cloud/import/scan_input.hpp"
#include "renderer/cloud/native/chunk_decoders.hpp"
#include "renderer/cloud/native/gathered_points.hpp"

namespace scancast {

struct NativeOpening {
    /// Empty: its own, with the limits that importers usually have.
    std::shared_ptr<ChunkDecoders> decoders{};
    std::shared_ptr<GatheredMemory> memory{};  ///< that all share; empty: each has its own
    std::optional<AssumedCrs> crs{};           ///< taken for the scans', whatever they say
    bool surfels = true;                       ///< normals and radii are estimated
    bool look = true;                          ///< decided
};

/// Whether it is a scan that can be shown as it is, in one file: COPC. Waits for its first bytes; what cannot be read is none.
bool canBeNative(const RandomReader& reader);

/// Whether something of this machine is: COPC, or EPT.
bool canBeNative(const ScanInput& input);

/// Which one it is.
struct NativeName {
    std::filesystem::path name;  ///< what messages call it
    std::string title;           ///< for people
    std::string identity;        ///< which state of it this is, as its ETag
};

/// Errors: those of openCopc().
Expected<std::shared_ptr<const CloudFile>> openNative(std::unique_ptr<RandomReader> reader, NativeName name,
                                                      const NativeOpening& opening,
                                                      std::vector<Mirror> mirrors = {});

/// A set of EPT. Errors: those of openEpt().
Expected<std::shared_ptr<const CloudFile>> openNative(std::shared_ptr<const FolderReader> files,
                                                      NativeName name, const NativeOpening& opening,
                                                      std::vector<Mirror> mirrors = {});

/// Either of this machine, with its mirrors; one that canBeNative().
Expected<std::shared_ptr<const CloudFile>> openNative(const ScanInput& input, const NativeOpening& opening);

}  // namespace scancast
