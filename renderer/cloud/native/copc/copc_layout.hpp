// What COPC adds to LAZ, byte for byte (copc.io, COPC 1.0): the record "copc" that stands first in the file, and the entries of the
// hierarchy's pages. Fixed sizes, pure functions; nothing here is believed beyond what its bytes say - copc_hierarchy.hpp holds it
// against the file. Pipeline: bytes → **layout** → hierarchy → native cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/error.hpp"
#include "renderer/cloud/native/voxel_tree.hpp"

namespace scancast {

/// From the start of the file on: LAS 1.4's header, the head of the first record, and its content.
inline constexpr std::size_t copcStartBytes = 589;
inline constexpr std::size_t copcEntryBytes = 32;

struct CopcInfo {
    VoxelCube cube;
    std::uint64_t pageOffset = 0, pageBytes = 0;  ///< the hierarchy's root page, from the start of the file
};

/// Whether a file with these first bytes is (meant to be) COPC.
bool isCopc(std::span<const std::byte> start);
/// Errors without the file's name: Truncated, Malformed.
Expected<CopcInfo> parseCopcInfo(std::span<const std::byte> start);

struct CopcEntry {
    VoxelKey key;
    std::uint64_t offset = 0;  ///< of the chunk, or the page
    std::int32_t bytes = 0;
    std::int32_t points = 0;  ///< -1: it is a page of the hierarchy; 0: a voxel without points of its own

    bool isPage() const { return points == -1; }
};

CopcEntry decodeCopcEntry(std::span<const std::byte, copcEntryBytes> bytes);
/// What is wrong with it, whatever file it is of; nullptr = nothing.
const char* wrongCopcEntry(const CopcEntry& entry);

}  // namespace scancast
