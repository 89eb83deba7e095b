// A frame's depth, made small: cells that share the picture out evenly, each with the depth of one pixel of its own.
// Pipeline: frame → **cells** → packed depth (protocol/depth/frame_depth.hpp). A pure function; any thread.
#pragma once

#include <array>

#include "protocol/depth/frame_depth.hpp"
#include "renderer/image/frame.hpp"

namespace scancast {

/// Width and height in cells: mostDepthCells along the longer side, the other in proportion and at least 2, but never more
/// cells than pixels.
std::array<int, 2> depthCellsOf(int width, int height);

/// Cell (i, j) has the pixels from i·W/w to below (i+1)·W/w, rounded down, and the same in height. Its depth is that of the
/// pixel with something in it whose centre is nearest to the middle of these - of several the first, in rows from the
/// top -; where no pixel has anything, background. The frame has depth.
DepthCells depthCells(const Frame& frame);

}  // namespace scancast
