// Bytes that belong together, compressed plane by plane: the part of a block that knows the compressor.
// Pure functions, from any thread. Pipeline: samples → transposed → **planes** → block.
//
// A plane is what one byte of a record is in every record; planes of different kinds share no statistics, so
// each is compressed by itself, or kept as it is, or as one byte where all are equal (decision 006).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// Records that are transposed and compressed at once: fits the second-level cache, and a full leaf.
inline constexpr std::size_t chunkRecords = 16384;
/// No stored byte stands for more than this many decoded ones: a plane of a chunk takes at least two bytes.
/// So the size of a block bounds what decoding it may allocate.
inline constexpr std::size_t largestExpansion = chunkRecords / 2;

/// Appends `planes` (each of `planeBytes` ≤ chunkRecords, one behind the other) to `block`.
void packPlanes(std::span<const std::byte> planes, std::size_t planeBytes, std::vector<std::byte>& block);

/// The inverse; takes what it used off the front of `block`. Malformed if these are not such planes.
Expected<void> unpackPlanes(std::span<const std::byte>& block, std::size_t planeBytes,
                            std::span<std::byte> planes);

}  // namespace scancast
