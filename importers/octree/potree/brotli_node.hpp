// A node of a Potree 2 octree with encoding BROTLI: attribute after attribute, positions and colours as Morton codes,
// compressed as a whole. Pure functions on bytes. Pipeline: node → **records** → points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "importers/octree/potree/potree_layout.hpp"

namespace scancast::import_octree {

/// Of one point, decompressed.
std::uint64_t brotliPointBytes(const PotreeLayout& layout);

/// Exactly points × brotliPointBytes(); never more memory than that and the window of the library. `node` is what messages
/// call it. Errors: Malformed, Truncated.
Expected<std::vector<std::byte>> unpackBrotli(std::span<const std::byte> compressed, std::uint64_t bytes,
                                              const std::string& node);

/// The points `first` … of `points` in unpacked bytes, as records of layout.points: as many as fit into `records`.
void brotliRecords(const PotreeLayout& layout, std::span<const std::byte> unpacked, std::uint64_t points,
                   std::uint64_t first, std::span<std::byte> records);

}  // namespace scancast::import_octree
