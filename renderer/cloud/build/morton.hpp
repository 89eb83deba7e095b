// Morton order: positions in the order in which an octree over all of space would list them. What lies in one
// cell of any power of two stands together. Pure functions.
#pragma once

#include <bit>
#include <cstdint>

#include "renderer/cloud/build/grid.hpp"

namespace scancast {

/// Two zero bits before each of 16 bits.
constexpr std::uint64_t spreadBits(std::uint64_t v) {
    v &= 0xffff;
    v = (v | v << 16) & 0x0000ff0000ffull;
    v = (v | v << 8) & 0x00f00f00f00full;
    v = (v | v << 4) & 0x0c30c30c30c3ull;
    v = (v | v << 2) & 0x249249249249ull;
    return v;
}

/// 48 bits from the lowest 16 of each.
constexpr std::uint64_t mortonKey(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return spreadBits(x) | spreadBits(y) << 1 | spreadBits(z) << 2;
}

/// The same order for positions of any width: the axis whose highest differing bit is the highest decides.
constexpr bool mortonLess(const GridPosition& a, const GridPosition& b) {
    std::uint64_t highest = 0;
    int axis = 2;
    for (int i = 2; i >= 0; --i) {
        const std::uint64_t differing = a[i] ^ b[i];
        if (highest < differing && highest < (highest ^ differing)) {
            highest = differing;
            axis = i;
        }
    }
    return a[axis] < b[axis];
}

/// The smallest cell level whose cells put both positions together: cells of 2^cellLevel steps.
constexpr int commonCellLevel(const GridPosition& a, const GridPosition& b) {
    return int(std::bit_width((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])));
}

/// How many cells a set of positions occupies, for every cell size at once.
class CellCount {
  public:
    /// Neighbours in Morton order, both occupied.
    void addStep(const GridPosition& a, const GridPosition& b, int cellLevel = 0) {
        ++steps_[commonCellLevel(a, b) + cellLevel];
    }
    void addFirst() { ++first_; }
    /// Occupied cells of 2^cellLevel steps. Cells smaller than the order's own resolution are not told apart.
    std::uint64_t cells(int cellLevel) const {
        std::uint64_t n = first_;
        for (int r = cellLevel + 1; r <= gridBits; ++r) n += steps_[r];
        return n;
    }

  private:
    std::array<std::uint64_t, gridBits + 1> steps_{};
    std::uint64_t first_ = 0;
};

}  // namespace scancast
