// The (extended) variable length records of a LAS file that Scancast uses: coordinate reference system, and
// what the extra bytes are. Pure functions on bytes.
//
// Nothing here can harm the points, so nothing here fails: a damaged record is passed over, and records are
// looked at only as far as they really reach, whatever number the header gives.
#pragma once

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

/// Takes over one record's content. The first of a kind wins.
void readVlr(std::span<const std::byte> userId, int recordId, std::span<const std::byte> content,
             LasVlrs& vlrs);

}  // namespace scancast
