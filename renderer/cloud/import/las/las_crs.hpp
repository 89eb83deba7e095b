// The coordinate reference system out of a LAS file's variable length records. Pure functions on bytes.
//
// Nothing here can harm the points, so nothing here fails: a damaged record is passed over, and records are
// looked at only as far as they really reach, whatever number the header gives.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace scancast {

struct LasCrs {
    std::string wkt;  ///< printable ASCII; empty = none
    std::optional<int> epsg;
};

/// Longest WKT that is taken over; longer ones are not CRS descriptions.
inline constexpr std::size_t longestCrsWkt = 65536;

/// One record's content, by its number within the user id "LASF_Projection". Keeps what `crs` has already.
void readProjectionRecord(int recordId, std::span<const std::byte> content, LasCrs& crs);

}  // namespace scancast
