// How values are distributed, in little memory, whatever they are: exact counts in cells of one width, a power
// of two, anchored at 0. Only cells that hold something are kept, and they widen when there are too many: so
// one stray value a billion away costs one cell, not the others' precision. What comes out does not depend on
// the order in which values came. Used by one thread. Pipeline: import → **staging** → facts.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "renderer/cloud/build/histogram_parts.hpp"

namespace scancast {

class ValueSketch {
  public:
    /// Values that are not finite are passed over.
    void add(double value);
    std::uint64_t count() const { return count_; }
    /// Value below which the share `q` (0-1) of all lies; at most a cell's width - about 1/2000 of where the
    /// values are - from the true one. 0 without values.
    double quantile(double q) const;
    /// 1st and 99th percentile.
    std::array<double, 2> usual() const { return {quantile(0.01), quantile(0.99)}; }

    /// How many values lie in each part, to a cell's width; whole numbers exactly, where cells are no wider than they are apart.
    ValueHistogram histogram(const HistogramParts& parts) const;

    /// As if its values had been added here.
    void join(const ValueSketch& other);
    /// All of it, to be sent to another process and joined there.
    template <class Visit>
    void forFields(Visit visit) {
        visit(table_);
        visit(used_);
        visit(exponent_);
        visit(scale_);
        visit(low_);
        visit(high_);
        visit(count_);
    }

  private:
    struct Cell {
        std::int64_t key = 0;
        std::uint64_t count = 0;  ///< 0 = free
    };
    static constexpr std::size_t places = 8192, mostCells = 4096;

    /// Place of the cell with this key, or of the free one that it would get.
    std::size_t find(std::int64_t key) const;
    void widen();
    /// So many values more in the cell with this key, which `last_` leads to then.
    void addCell(std::int64_t key, std::uint64_t count);

    std::vector<Cell> table_ = std::vector<Cell>(places);
    std::size_t used_ = 0;
    int exponent_ = -64;  ///< a cell's width is 2^exponent
    double scale_ = 0x1p64;
    double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
    std::uint64_t count_ = 0;
    std::size_t last_ = 0;  ///< place of the value before: neighbours in a scan are alike
};

}  // namespace scancast
