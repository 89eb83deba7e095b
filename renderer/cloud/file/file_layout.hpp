// Header and node records of a cloud file, byte for byte (CLOUD_FILE.md). Pure functions on bytes.
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
inline constexpr std::uint32_t cloudFileVersion = 1;
inline constexpr std::size_t cloudHeaderBytes = 128;
inline constexpr std::size_t nodeRecordBytes = 208;

/// In the order of the file; they leave no gap.
extern const std::array<FileField, 14> cloudHeaderFields;
extern const std::array<FileField, 25> nodeRecordFields;

struct CloudFileHeader {
    std::uint64_t fileBytes = 0;
    BlockPlace index;  ///< `bytes` is not used: nodes · nodeRecordBytes
    std::uint32_t nodes = 0;
    std::uint64_t factsOffset = 0, factsBytes = 0, factsChecksum = 0;

    std::uint64_t indexBytes() const { return std::uint64_t(nodes) * nodeRecordBytes; }
    bool operator==(const CloudFileHeader&) const = default;
};

std::array<std::byte, cloudHeaderBytes> encodeHeader(const CloudFileHeader& header);
/// Of the first bytes of a file of `fileBytes` bytes, as many of them as there are (up to cloudHeaderBytes).
/// What it returns is consistent: index and facts lie behind one another at the end of the file. Errors
/// without the file's name: Unsupported, Truncated, Malformed.
Expected<CloudFileHeader> parseHeader(std::span<const std::byte> start, std::uint64_t fileBytes);

void encodeNode(const StoredNode& node, std::span<std::byte, nodeRecordBytes> record);
StoredNode decodeNode(std::span<const std::byte, nodeRecordBytes> record);
/// Whether the bytes that mean nothing are zero.
bool reservedAreZero(std::span<const std::byte, nodeRecordBytes> record);

/// XXH3, 64 bits.
std::uint64_t checksumOf(std::span<const std::byte> bytes);

}  // namespace scancast
