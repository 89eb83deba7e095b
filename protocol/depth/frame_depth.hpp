// The small picture of its depth that a frame brings along, behind the fixed part of its header, for clients that ask for
// it in `hello`: cells → a few kilobytes → cells. PROTOCOL.md, "Depth of a frame", is the reference for readers.
//
// Pure functions; any thread. The same cells give the same bytes. Pipeline: frame → cells
// (renderer/image/depth_cells.hpp) → **packed depth** → frame header → net → client. zlib stays in the .cpp.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/error.hpp"
#include "protocol/frame_header.hpp"

namespace scancast {

/// Cells in either direction.
inline constexpr int mostDepthCells = 160;

/// Depths in cells that share the picture out evenly.
struct DepthCells {
    int width = 0, height = 0;  ///< 1 to mostDepthCells
    /// width·height in rows from the top: along the view direction, cloud units, > 0; +infinity = background.
    std::vector<float> depth;
};

/// What stands between the 48 bytes of a frame's header and its picture: the fields of `frameDepthFields`, then a zlib
/// stream. At most 52 kB, a few in practice. Errors: InvalidArgument for cells that are none; ResourceLimit.
Expected<std::vector<std::uint8_t>> packDepth(const DepthCells& cells);

struct FrameDepth {
    int width = 0, height = 0;
    float near = 0, far = 0;     ///< the least and greatest depth among the cells; both 0 where all is background
    std::vector<float> inverse;  ///< width·height in rows from the top: 1 / depth, within 1/1024; 0 = background
};

/// Of ParsedFrame::packedDepth. Unpacks no more than the cells are. Errors: Truncated, Malformed; ResourceLimit.
Expected<FrameDepth> unpackDepth(std::span<const std::uint8_t> packed);

}  // namespace scancast
