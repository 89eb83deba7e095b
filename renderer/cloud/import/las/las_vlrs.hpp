// The (extended) variable length records of a LAS file that Scancast uses: coordinate reference system, and
// what the extra bytes are. Pure functions on bytes.
//
// Nothing here can harm the points, so nothing here fails: a damaged record is passed over, and records are
// looked at only as far as they really reach, whatever number the header gives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/cloud/import/las/las_crs.hpp"

namespace scancast {

struct LasVlrs {
    LasCrs crs;
    std::vector<std::byte> extraBytes;  ///< content of LASF_Spec 4; empty = none
};

/// The longest content that is of use.
inline constexpr std::size_t longestVlr = 65536;

/// Reads the records of `bytes`, the part of the file between header and points. `count` as declared.
void readVlrs(std::span<const std::byte> bytes, std::uint64_t count, LasVlrs& vlrs);

/// Does the record with this 16-byte user id and number concern us?
bool isWantedVlr(std::span<const std::byte> userId, int recordId);

/// What stands before the content of an extended record.
struct EvlrHead {
    std::array<std::byte, 16> userId{};
    int recordId = 0;
    std::uint64_t length = 0;  ///< of the content

    bool isWanted() const { return isWantedVlr(userId, recordId) && length <= longestVlr; }
};
inline constexpr std::size_t evlrHeadBytes = 60;
EvlrHead parseEvlrHead(std::span<const std::byte, evlrHeadBytes> bytes);

/// At most so many of them are looked at.
inline constexpr std::uint32_t mostEvlrs = 1000;
/// Reads extended records that stand one behind the other.
void readEvlrs(std::span<const std::byte> bytes, LasVlrs& vlrs);

/// Takes over one record's content. The first of a kind wins.
void readVlr(std::span<const std::byte> userId, int recordId, std::span<const std::byte> content,
             LasVlrs& vlrs);

}  // namespace scancast
