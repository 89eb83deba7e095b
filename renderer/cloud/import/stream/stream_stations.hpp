// The point stream's stations: where the scanner stood, as JSON. Pure functions.
// Pipeline: importer process → **point stream** → points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/error.hpp"
#include "renderer/cloud/stations/station.hpp"

namespace scancast::point_stream {

inline constexpr std::size_t longestStation = 4096;       ///< bytes of one
inline constexpr std::size_t mostStreamStations = 65536;  ///< of one stream
/// FROM: nobody knows where the points that follow were recorded from.
inline constexpr std::uint32_t fromNowhere = 0xffffffffU;

/// All but its number of points.
std::string encodeStation(const Station& station);

/// Trusts nothing in it. Errors: Importer, without a file's name.
Expected<Station> decodeStation(std::string_view text);

}  // namespace scancast::point_stream
