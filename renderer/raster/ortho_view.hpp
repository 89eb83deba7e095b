// An orthophoto's blocks as views from straight above, so that they are drawn as every picture is: any method, any colour, on any device.
// Pipeline: request + cloud → **view of a block** → plan → prepare → draw → TIFF. Pure functions; any thread.
//
// A pixel is a cell. What is small enough is one picture, the same as that view's snapshot. What is not is drawn block by block, each with
// a margin as wide as its screen passes look, and all of them of one size, which some methods go by; methods that look farther than any
// margin (pyramid) may differ in a few pixels along blocks' edges.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "renderer/image/pixels.hpp"
#include "renderer/plan.hpp"
#include "renderer/raster/raster_grid.hpp"

namespace scancast {

struct OrthoViews {
    RasterGrid grid{};  ///< its blocks are those that are drawn
    View base{};        ///< of every block, but for its camera and size
    int margin = 0;     ///< px around each block; 0 where there is one
};

/// `grid`: the raster's; its blocks become those that suit pictures of at most `largest` on a side. Errors: those of the view's words and
/// of plan().
Expected<OrthoViews> orthoViews(const Cloud& cloud, RasterGrid grid, const WordValues& words,
                                int largest = 2048);

/// The view of a block, which has its margin around it.
View orthoView(const Cloud& cloud, const OrthoViews& views, const CellWindow& block);

/// A block's cells out of its view's picture: `rgba` is width · height · 4 of that; Internal where it is not.
Expected<std::vector<std::byte>> cellsOf(const OrthoViews& views, const CellWindow& block,
                                         std::span<const std::uint8_t> rgba);

}  // namespace scancast
