// What a LAS point record holds besides the sample: GPS time, returns, angles, flags, infrared, extra bytes.
// Pure functions. Pipeline: bytes → header → **records** → rows beside the points.
//
// Waveform packets are not kept: their offsets point into another part of the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/cloud/import/las/las_header.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// One column and where its numbers are: `bytes` of them at `at` in a record, or `bits` of one byte.
struct LasColumn {
    Column column;
    std::uint32_t at = 0;
    std::uint8_t bytes = 1;
    std::uint8_t shift = 0;
    std::uint8_t bits = 8;  ///< fewer than 8 only where bytes = 1
};

/// Columns of extra bytes, at most; what lies beyond is left out. (A record may have 65,000 of them.)
inline constexpr std::size_t mostExtraColumns = 256;

/// The columns of the point format, then those of the extra bytes. `description` is the content of the Extra
/// Bytes record (LASF_Spec 4), empty = none. What it says wrongly is ignored, and bytes that it does not
/// describe become columns extra_0, extra_1 … of one byte each.
/// `fullColors`: colours are columns, too, as they stand (exact_columns.hpp).
std::vector<LasColumn> lasColumns(const LasHeader& header, std::span<const std::byte> description,
                                  bool fullColors = false);

/// What gps_time is described as where its epoch is known.
inline constexpr const char* adjustedTimeText =
    "adjusted standard GPS time: seconds since 1980-01-06, less 1e9";

/// Fills `rows` with one row a record.
void decodeLasColumns(std::span<const std::byte> records, std::size_t recordBytes,
                      std::span<const LasColumn> columns, std::vector<std::byte>& rows);

}  // namespace scancast
