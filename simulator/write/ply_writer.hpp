// PLY, binary little-endian. Positions are floats where these hold a tenth of a millimetre, doubles
// otherwise.
#pragma once

#include "simulator/write/point_writer.hpp"

namespace scancast {

Expected<std::unique_ptr<PointWriter>> createPlyWriter(OutputFile output, const ScanHeader& header);

}  // namespace scancast
