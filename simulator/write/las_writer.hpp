// LAS (ASPRS), uncompressed: 1.2 with point format 2, or 1.4 with point format 7.
#pragma once

#include "simulator/write/point_writer.hpp"

namespace scancast {

/// Bounds in the file are those of the points where the output can be gone back to; in a pipe, the declared
/// ones.
Expected<std::unique_ptr<PointWriter>> createLasWriter(bool version14, OutputFile output,
                                                       const ScanHeader& header);

}  // namespace scancast
