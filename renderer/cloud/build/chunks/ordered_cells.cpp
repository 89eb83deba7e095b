#include "renderer/cloud/build/chunks/ordered_cells.hpp"

#include <algorithm>
#include <span>

namespace scancast {

namespace {

std::vector<CountedCell> merged(std::span<const CountedCell> a, std::span<const CountedCell> b) {
    std::vector<CountedCell> all;
    all.reserve(a.size() + b.size());
    while (!a.empty() && !b.empty()) {
        CountedCell next = a.front().key <= b.front().key ? a.front() : b.front();
        if (a.front().key == b.front().key) next.points += b.front().points;
        if (a.front().key == next.key) a = a.subspan(1);
        if (b.front().key == next.key) b = b.subspan(1);
        all.push_back(next);
    }
    all.insert(all.end(), a.begin(), a.end());
    all.insert(all.end(), b.begin(), b.end());
    return all;
}

}  // namespace

CellFrame frameOf(const GridBox& box, int cellLevel) {
    CellFrame frame{.first = {}, .cellLevel = cellLevel};
    for (std::size_t a = 0; a < 3; ++a) frame.first[a] = box.min[a] >> cellLevel;
    return frame;
}

OrderedCells coarsened(OrderedCells fine, const GridBox& box, int cellLevel) {
    if (cellLevel == fine.frame.cellLevel) return fine;
    OrderedCells coarse{.frame = frameOf(box, cellLevel), .cells = {}};
    // Neighbours in a row become one at once; rows that become one are put together afterwards.
    for (const CountedCell& cell : fine.cells) {
        GridPosition p;
        for (int a = 0; a < 3; ++a)
            p[std::size_t(a)] = (fine.frame.first[std::size_t(a)] + cellAxis(cell.key, a))
                                << fine.frame.cellLevel;
        const CellKey key = coarse.frame.key(p);
        if (!coarse.cells.empty() && coarse.cells.back().key == key)
            coarse.cells.back().points += cell.points;
        else
            coarse.cells.push_back({key, cell.points});
    }
    std::ranges::sort(coarse.cells, {}, &CountedCell::key);
    std::size_t kept = 0;
    for (const CountedCell& cell : coarse.cells) {
        if (kept > 0 && coarse.cells[kept - 1].key == cell.key)
            coarse.cells[kept - 1].points += cell.points;
        else
            coarse.cells[kept++] = cell;
    }
    coarse.cells.resize(kept);
    return coarse;
}

OrderedCells joined(OrderedCells a, OrderedCells b, const GridBox& box) {
    const int cellLevel = std::max(a.frame.cellLevel, b.frame.cellLevel);
    a = coarsened(std::move(a), box, cellLevel);
    b = coarsened(std::move(b), box, cellLevel);
    a.cells = merged(a.cells, b.cells);
    while (a.cells.size() > CountingGrid::mostCells) {
        const int coarser = a.frame.cellLevel + 1;
        a = coarsened(std::move(a), box, coarser);
    }
    return a;
}

}  // namespace scancast
