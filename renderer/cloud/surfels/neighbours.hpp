// The distinct positions among a set of points, in an order and a hierarchy of boxes that finds nearest
// neighbours. Owned by estimateSurfels() for the time of one call; immutable once made, any thread may read.
// Pipeline: points of a chunk → **neighbours** → surfels.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "renderer/cloud/surfels/kernels/surfel_kernels.hpp"

namespace scancast {

/// Positions are finite; -0 and 0 are the same. What it says depends on the set of points alone, but for the
/// order of equal positions in pointsAt().
class NeighbourIndex {
  public:
    explicit NeighbourIndex(std::span<const glm::vec3> points);

    /// Distinct positions.
    std::uint32_t size() const { return view_.points; }
    /// All numbers below `p` in the index' own order (Morton's).
    const surfel::IndexView& view() const { return view_; }
    glm::vec3 position(std::uint32_t p) const { return {x_[p], y_[p], z_[p]}; }
    /// Which of the given points are at position p.
    std::span<const std::uint32_t> pointsAt(std::uint32_t p) const {
        return std::span(order_).subspan(firstOf_[p], firstOf_[p + 1] - firstOf_[p]);
    }
    /// Runs of at most surfel::groupSize positions that stand together: the first of each, and the end.
    std::span<const std::uint32_t> groups() const { return groupBegin_; }

  private:
    void fill(std::span<const glm::vec3> points);
    void makeBoxes();

    std::vector<std::uint32_t> order_, firstOf_, groupBegin_, leafBegin_;
    std::vector<float> x_, y_, z_;
    std::vector<surfel::BoxBlock> blocks_;
    surfel::IndexView view_;
};

}  // namespace scancast
