// LASzip's record: how the points of a LAZ file are compressed. Parsed and held against the LAS header. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/error.hpp"

namespace scancast::laz {

/// What a compressed record is made of, by LASzip's numbers.
enum class ItemKind : std::uint16_t {
    Bytes = 0,
    Point10 = 6,
    GpsTime11 = 7,
    Rgb12 = 8,
    WavePacket13 = 9,
    Point14 = 10,
    Rgb14 = 11,
    RgbNir14 = 12,
    WavePacket14 = 13,
    Bytes14 = 14,
};

struct Item {
    ItemKind kind = ItemKind::Bytes;
    std::uint32_t bytes = 0;
    int version = 0;
};

enum class Compressor { None = 0, Pointwise = 1, Chunked = 2, Layered = 3 };

/// In the place of the points of a chunk: the chunk table says it for each.
inline constexpr std::uint32_t variableChunks = 0xffffffff;

struct LaszipRecord {
    Compressor compressor = Compressor::None;
    std::uint32_t chunkPoints =
        0;                    ///< variableChunks, or a number; without meaning where there are no chunks
    std::vector<Item> items;  ///< in their order within a record
};

/// Bytes of a record of point formats 0-10 without extra bytes.
std::uint32_t leastRecordBytes(int pointFormat);

/// `content`: of the variable length record "laszip encoded", 22204. Errors: Malformed, where it does not describe records of
/// that format and length; Unsupported, ResourceLimit.
Expected<LaszipRecord> parseLaszipRecord(std::span<const std::byte> content, int pointFormat,
                                         std::uint32_t recordBytes);

}  // namespace scancast::laz
