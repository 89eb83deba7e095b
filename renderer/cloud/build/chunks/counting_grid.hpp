// How many points lie in each cell of a coarse grid: what a cloud too large for memory is divided by.
// Pipeline: staging → **counting grid** → chunk layout → chunks. Source: docs/spec/hierarchy.md §2.
//
// Cells are cubes of 2^cellLevel grid steps, anchored at the grid's 0; the cell level is the finest that leaves at most
// mostCells of them occupied, and so depends on the set of points alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/cloud/build/grid.hpp"

namespace scancast {

/// A cell's index relative to the cell that holds the minimum corner: 21 bits an axis, x lowest.
using CellKey = std::uint64_t;

struct CellFrame {
    GridPosition first{};  ///< index, at the cell level, of the cell that keys count from
    int cellLevel = 0;

    CellKey key(const GridPosition& p) const {
        return ((p[0] >> cellLevel) - first[0]) | ((p[1] >> cellLevel) - first[1]) << 21 |
               ((p[2] >> cellLevel) - first[2]) << 42;
    }
};
inline std::uint32_t cellAxis(CellKey key, int axis) {
    return std::uint32_t(key >> (21 * axis) & 0x1fffffu);
}

/// So many points ahead of the one whose cell is looked up, the next one's is expected.
inline constexpr std::size_t cellsExpected = 16;

struct CountedCell {
    CellKey key = 0;
    std::uint64_t points = 0;
};

/// From CellKey to a number: a small open hash table.
class CellTable {
  public:
    explicit CellTable(std::size_t expected = 0);
    std::uint64_t& operator[](CellKey key);        ///< 0 when new
    const std::uint64_t* find(CellKey key) const;  ///< null when there is none
    /// The key will be asked for soon: what its place in memory costs is waited for meanwhile.
    void expect(CellKey key) const { __builtin_prefetch(slots_.data() + placeOf(key)); }
    std::size_t size() const { return size_; }
    template <class Use>
    void forEach(Use use) const {
        for (const CountedCell& slot : slots_)
            if (slot.key != empty) use(slot.key, slot.points);
    }

  private:
    static constexpr CellKey empty = ~CellKey(0);
    /// Each size hashes in its own way: walking one table while filling a smaller one would else meet the keys
    /// in the order of their places, and crowd them.
    std::size_t placeOf(CellKey key) const {
        return (key * (0x9e3779b97f4a7c15ull ^ (shift_ * 0x5851f42d4c957f2cull))) >> shift_;
    }
    std::size_t slotOf(CellKey key) const;
    void grow();

    std::vector<CountedCell> slots_;
    std::size_t size_ = 0;
    unsigned shift_ = 0;
};

/// Counts for one thread; several are joined.
class CountingGrid {
  public:
    static constexpr std::size_t mostCells = 1 << 20;

    /// For points in this box; starts with at most 1024 cells along the longest axis.
    explicit CountingGrid(const GridBox& box);
    void add(std::span<const BuildPoint> points);
    void join(const CountingGrid& other);

    const CellFrame& frame() const { return frame_; }
    /// Occupied cells, ordered by key.
    std::vector<CountedCell> cells() const;
    /// To a level that is not finer.
    void coarsenTo(int cellLevel);

  private:
    void coarsenIfFull();

    GridBox box_;
    CellFrame frame_;
    CellTable table_;
};

}  // namespace scancast
