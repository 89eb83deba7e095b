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
/// What is written. Versions 1 and 2 are read, too.
inline constexpr std::uint32_t cloudFileVersion = 3;
/// From this one on both indices are packed (packed_index.hpp).
inline constexpr std::uint32_t firstPackedVersion = 3;
inline constexpr std::size_t cloudHeaderBytes = 128;
inline constexpr std::size_t nodeRecordBytes = 208;
inline constexpr std::size_t planeRecordBytes = 24;
/// Of a packed record, its checksum at least is stored as it is: so the length of an index bounds how many it may hold.
inline constexpr std::size_t leastPackedBytes = 8;

/// In the order of the file; they leave no gap. Offsets stand here once: what encodes and decodes walks through the same order.
inline constexpr std::array<FileField, 17> cloudHeaderFields{{{0, 8, "magic"},
                                                              {8, 4, "version"},
                                                              {12, 4, "headerBytes"},
                                                              {16, 8, "fileBytes"},
                                                              {24, 8, "indexOffset"},
                                                              {32, 8, "indexBytes"},
                                                              {40, 8, "indexChecksum"},
                                                              {48, 8, "factsOffset"},
                                                              {56, 8, "factsBytes"},
                                                              {64, 8, "factsChecksum"},
                                                              {72, 4, "nodes"},
                                                              {76, 4, "nodeRecordBytes"},
                                                              {80, 8, "planesOffset"},
                                                              {88, 8, "planesBytes"},
                                                              {96, 8, "planesChecksum"},
                                                              {104, 16, "zero"},
                                                              {120, 8, "headerChecksum"}}};

inline constexpr std::array<FileField, 23> nodeRecordFields{
    {{0, 24, "boxMin"},         {24, 24, "step"},
     {48, 24, "boxMax"},        {72, 24, "center"},
     {96, 8, "radius"},         {104, 4, "spacing"},
     {108, 4, "meanSpacing"},   {112, 4, "radiusUnit"},
     {116, 12, "coneAxis"},     {128, 4, "coneHalfAngle"},
     {132, 4, "parent"},        {136, 4, "firstChild"},
     {140, 1, "childCount"},    {141, 1, "level"},
     {142, 1, "confidence"},    {143, 1, "zero"},
     {144, 4, "sampleCount"},   {148, 4, "samplesBytes"},
     {152, 8, "firstSample"},   {160, 8, "points"},
     {168, 8, "samplesOffset"}, {176, 8, "samplesChecksum"},
     {184, 24, "zero"}}};

inline constexpr std::array<FileField, 4> planeRecordFields{
    {{0, 8, "offset"}, {8, 8, "checksum"}, {16, 4, "bytes"}, {20, 4, "zero"}}};

/// Where a field begins, of a table that has it.
template <std::size_t N>
consteval std::size_t offsetIn(const std::array<FileField, N>& fields, std::string_view name) {
    for (const FileField& field : fields)
        if (field.name == name) return field.offset;
    throw "there is no such field";
}

/// What is read in one piece, or front to back, and is no block.
struct FilePart {
    std::uint64_t offset = 0, bytes = 0, checksum = 0;
    std::uint64_t end() const { return offset + bytes; }
    bool operator==(const FilePart&) const = default;
};

/// Where the parts of a file of any version lie. Version 1 has no index of planes: its is empty.
struct CloudFileHeader {
    std::uint32_t version = cloudFileVersion;
    std::uint64_t fileBytes = 0;  ///< up to the end of the facts; what stands behind means nothing
    std::uint32_t nodes = 0;
    FilePart index, planes, facts;
    bool operator==(const CloudFileHeader&) const = default;
};

/// Of a file of `header.version`.
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
