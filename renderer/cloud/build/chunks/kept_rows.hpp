// Rows of kept columns, brought into the order that the octree gives the points. Points of a chunk are told
// apart by what they are; among equal ones, rows stand in the order of their bytes, so that the result does
// not depend on the order in which points were read.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/cloud/build/grid.hpp"

namespace scancast {

class KeptRows {
  public:
    /// One row of rowBytes per point. Copies both: the builder reorders points in place.
    KeptRows(std::span<const BuildPoint> points, std::span<const std::byte> rows, std::size_t rowBytes);

    /// The rows of a leaf's points, in their order. Equal points must stand together, and all of them be
    /// there.
    std::vector<std::byte> rowsOf(std::span<const BuildPoint> leaf) const;

  private:
    std::span<const std::byte> row(std::uint32_t index) const {
        return std::span(rows_).subspan(index * rowBytes_, rowBytes_);
    }

    std::size_t bucketOf(const BuildPoint& point) const;

    std::vector<BuildPoint> points_;
    std::vector<std::byte> rows_;
    std::size_t rowBytes_;
    int bucketBits_ = 0;
    std::vector<std::uint32_t> first_;  ///< of each bucket in order_, and the end
    std::vector<std::uint32_t> order_;  ///< by bucket, in it by point, then by row
};

}  // namespace scancast
