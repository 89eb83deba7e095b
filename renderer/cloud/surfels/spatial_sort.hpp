// Points in Morton order, equal positions together, cut where the order's cells end. Pure function; uses the
// caller's TBB arena. Pipeline: part of neighbours.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace scancast {

struct SpatialOrder {
    std::vector<std::uint32_t> order;       ///< the points' numbers
    std::vector<std::uint32_t> firstOf;     ///< in `order`, of each distinct position; and the end
    std::vector<std::uint32_t> leafBegin;   ///< distinct positions, ≤ 8 a leaf; and the end
    std::vector<std::uint32_t> groupBegin;  ///< whole leaves, ≤ 16 positions a group; and the end
};

/// Cells are found relative to the points' own box; one that holds too many is ordered again within its own,
/// so any mixture of scales, and any number of equal points, is split in O(n log n).
SpatialOrder spatialOrder(std::span<const glm::vec3> points);

}  // namespace scancast
