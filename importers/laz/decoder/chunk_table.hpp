// Where the chunks of a LAZ file are and how many points each has, held against the file before anything is believed.
// Pure functions on a file.
#pragma once

#include <vector>

#include "importers/laz/decoder/las_shape.hpp"
#include "importers/laz/decoder/laszip_record.hpp"
#include "importers/laz/decoder/random_access.hpp"

namespace scancast::laz {

/// Points that are decoded from the first to the last, on their own.
struct Chunk {
    std::uint64_t at = 0, bytes = 0;      ///< of the file
    std::uint64_t first = 0, points = 0;  ///< of all points of the file
    /// Where nobody wrote down where the chunks begin: after so many points the next one follows. 0 = it is one.
    std::uint64_t restart = 0;
    /// Whether its last point ends at its last byte.
    bool exact = true;
};

/// At least one, in the order of the file; together all points. `mayBeCut`: where the table is missing, the whole file is one that restarts.
/// Errors: Malformed, Truncated, ResourceLimit, Io.
Expected<std::vector<Chunk>> readChunks(const RandomAccess& file, const LasShape& shape,
                                        const LaszipRecord& laszip, bool mayBeCut);

}  // namespace scancast::laz
