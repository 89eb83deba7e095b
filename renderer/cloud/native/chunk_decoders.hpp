// Programs that decode what a voxel's points are packed in - chunks and files of LAZ, records compressed by zstd -, each shut in as importers are (decision 18): started when they are needed, asked again and again, as many at
// once as this machine has use for, and started anew where one crashed or hangs. None has chunks of two clouds, so what a chunk does to its decoder costs its cloud.
// Owned by whoever opens native clouds, together with them. *Thread safety*: decode() may be called from any thread, and waits for a program that
// is free. Place: fetched chunk → **chunk decoders** → records.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/cloud/import/stream/chunk_messages.hpp"

namespace scancast {

/// How the records of a file are, and how they are packed.
struct ChunkShape {
    std::uint32_t pointFormat = 0, recordBytes = 0;
    std::vector<std::byte> laszip{};  ///< of chunks: the content of the record "laszip encoded"
    /// Whose chunks they are: a program has seen those of one alone, so that what takes it over finds nobody else's.
    std::uint64_t owner = 0;
    chunk_messages::Packing packing = chunk_messages::Packing::LazChunk;
};

class ChunkDecoders {
  public:
    /// By `scancast-import-laz --chunks` and `scancast-import-octree --chunks`; `most` at once, 0 = as many as there are cores, four at most.
    static std::shared_ptr<ChunkDecoders> create(ImportOptions options, int most = 0);
    virtual ~ChunkDecoders() = default;
    /// The chunk's records as LAS has them, points × recordBytes bytes. Errors, without the file's name: Malformed, Truncated, Unsupported:
    /// the chunk; Importer: the program; ResourceLimit.
    virtual Expected<std::vector<std::byte>> decode(const ChunkShape& shape, std::uint64_t points,
                                                    std::span<const std::byte> chunk) = 0;
};

}  // namespace scancast
