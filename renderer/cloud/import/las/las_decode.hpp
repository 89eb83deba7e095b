// LAS point records to columns: the inner loop of reading. Pure functions.
// Pipeline: bytes → header → **records** → points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "renderer/cloud/import/las/las_header.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// How the three 16-bit numbers of a record's colour are meant. The format says 16 bits; many programs
/// write 8.
enum class LasColorDepth : std::uint8_t {
    Unknown,    ///< only zeros so far: both readings give black
    EightBits,  ///< no number above 255
    SixteenBits,
};

/// `records` holds whole records only (size = count × header.recordBytes). Fills every column of the point
/// format, positions as steps of the header's grid. 16-bit colours keep their high byte, which undoes both usual ways of making 16 bits of 8 (× 256
/// and × 257). Near infrared stays as it is: of how many bits it is, the builder sees. Class flags and withheld points are kept as points; bits that are not part of the class are
/// dropped.
void decodeLasRecords(std::span<const std::byte> records, const LasHeader& header, LasColorDepth depth,
                      PointBatch& batch);

/// Highest colour number's evidence: SixteenBits as soon as one is above 255, EightBits if one is above 0.
LasColorDepth colorDepth(std::span<const std::byte> records, const LasHeader& header);

/// Takes points with a NaN or infinite coordinate out of all columns. Returns how many.
std::uint64_t dropNonFinite(PointBatch& batch);

}  // namespace scancast
