// Scans that are shown as they are, without ingest: what opens them for commands and for the loader, with a look. Waits for what is read.
// Free functions; any thread. Place: bytes → **native cloud** → residency.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/random_reader.hpp"
#include "renderer/cloud/copc/chunk_decoders.hpp"
#include "renderer/cloud/copc/gathered_points.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/import/assumed_crs.hpp"

namespace scancast {

struct NativeOpening {
    /// Empty: its own, with the limits that importers usually have.
    std::shared_ptr<ChunkDecoders> decoders{};
    std::shared_ptr<GatheredMemory> memory{};  ///< that all share; empty: each has its own
    std::optional<AssumedCrs> crs{};           ///< taken for the scans', whatever they say
    bool surfels = true;                       ///< normals and radii are estimated
    bool look = true;                          ///< decided
};

/// Whether it is a scan that can be shown as it is: COPC. Waits for its first bytes; what cannot be read is none.
bool canBeNative(const RandomReader& reader);

/// The same of a file of this machine.
bool isCopcFile(const InputFile& file);

/// `name` is what messages call it; `mirrors` stand beside it; `identity`: which state of it this is, as its ETag. Errors: those of openCopc().
Expected<std::shared_ptr<const CloudFile>> openNative(std::unique_ptr<RandomReader> reader,
                                                      const std::filesystem::path& name,
                                                      const std::string& identity,
                                                      const NativeOpening& opening,
                                                      std::vector<Mirror> mirrors = {});

/// The same of a file of this machine.
Expected<std::shared_ptr<const CloudFile>> openNative(InputFile file, const NativeOpening& opening,
                                                      std::vector<Mirror> mirrors = {});

}  // namespace scancast
