// Header and records of a cloud file, byte for byte (CLOUD_FILE.md). Pure functions on bytes.
// Pipeline: nodes → **records** → cloud file, and back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocol/error.hpp"
#include "renderer/cloud/file/block_place.hpp"

namespace scancast {

/// A field's name in CLOUD_FILE.md, and where it stands.
struct FileField {
    std::size_t offset, bytes;
    std::string_view name;
};

inline constexpr std::array<char, 8> cloudFileMagic{'S', 'C', 'A', 'N', 'C', 'L', 'D', '\x1a'};
/// What is written. Version 1 is read, too.
inline constexpr std::uint32_t cloudFileVersion = 2;
inline constexpr std::size_t cloudHeaderBytes = 128;
inline constexpr std::size_t nodeRecordBytes = 208;
inline constexpr std::size_t planeRecordBytes = 24;

/// In the order of the file; they leave no gap.
extern const std::array<FileField, 17> cloudHeaderFields;
extern const std::array<FileField, 23> nodeRecordFields;
extern const std::array<FileField, 4> planeRecordFields;

/// What is read in one piece, or front to back, and is no block.
struct FilePart {
    std::uint64_t offset = 0, bytes = 0, checksum = 0;
    std::uint64_t end() const { return offset + bytes; }
    bool operator==(const FilePart&) const = default;
};

/// Where the parts of a file of either version lie. Version 1 has no index of planes: its is empty.
struct CloudFileHeader {
    std::uint32_t version = cloudFileVersion;
    std::uint64_t fileBytes = 0;  ///< up to the end of the facts; what stands behind means nothing
    std::uint32_t nodes = 0;
    FilePart index, planes, facts;
    bool operator==(const CloudFileHeader&) const = default;
};

/// As cloudFileVersion has it.
std::array<std::byte, cloudHeaderBytes> encodeHeader(const CloudFileHeader& header);
/// Of the first bytes of a file of `fileBytes` bytes, as many of them as there are (up to cloudHeaderBytes).
/// What it returns is consistent: index, planes' index and facts lie behind one another, within the file.
/// Errors without the file's name: Unsupported, Truncated, Malformed.
Expected<CloudFileHeader> parseHeader(std::span<const std::byte> start, std::uint64_t fileBytes);

using NodeRecord = std::span<const std::byte, nodeRecordBytes>;
void encodeNode(const StoredNode& node, std::span<std::byte, nodeRecordBytes> record);
StoredNode decodeNode(NodeRecord record);
/// Version 1 only: where a node's rows are.
BlockPlace decodeRowsPlace(NodeRecord record);
/// Whether the bytes that mean nothing in this version are zero.
bool reservedAreZero(NodeRecord record, std::uint32_t version);

using PlaneRecord = std::span<const std::byte, planeRecordBytes>;
void encodePlane(const BlockPlace& place, std::span<std::byte, planeRecordBytes> record);
BlockPlace decodePlane(PlaneRecord record);
bool reservedAreZero(PlaneRecord record);

/// XXH3, 64 bits.
std::uint64_t checksumOf(std::span<const std::byte> bytes);

}  // namespace scancast
