// Records of a tile that Zstandard has compressed, decompressed piece by piece: however many it has, memory is that of its
// window, and it cannot hold more bytes than its points need. Pure function. Pipeline: tile → **records** → points.
#pragma once

#include "importers/octree/tree/octree.hpp"

namespace scancast::import_octree {

/// Hands over `points` records; see Octree::read(). `tile` is what messages call the file. Errors: Malformed where it does
/// not hold exactly them, Truncated, Io.
Expected<void> readZstdRecords(const TreeFile& file, const std::string& tile, std::uint64_t points,
                               const Wanted& wanted, const RecordDecoder& decoder,
                               const Octree::TakeRecords& take);

/// Bytes that it takes at most, for records of so many bytes in all.
std::uint64_t zstdMemory(std::uint64_t recordsBytes);

}  // namespace scancast::import_octree
