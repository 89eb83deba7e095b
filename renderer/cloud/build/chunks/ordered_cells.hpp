// What a counting grid has counted, ordered by key: how several processes put their counts together. Joining two lists is a walk, where
// joining two tables looks up every cell at a random place. Plain values and pure functions. Pipeline: counting grids → **ordered cells**
// → chunk layout.
#pragma once

#include <vector>

#include "renderer/cloud/build/chunks/counting_grid.hpp"

namespace scancast {

struct OrderedCells {
    CellFrame frame;
    std::vector<CountedCell> cells;  ///< ordered by key, each key once
};

/// The cells that points in `box` have at a level; keys count from its minimum corner.
CellFrame frameOf(const GridBox& box, int cellLevel);
/// Cells of a finer level, or of the same one, at this level.
OrderedCells coarsened(OrderedCells cells, const GridBox& box, int cellLevel);
/// What one counting grid for `box` has after all points of both: cells of the finest level that both have and that leaves few enough.
OrderedCells joined(OrderedCells a, OrderedCells b, const GridBox& box);

}  // namespace scancast
