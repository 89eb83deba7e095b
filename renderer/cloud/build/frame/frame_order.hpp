// A frame's points in Morton order: what lies in one cell of any power of two stands together, so that cells and
// octree nodes are runs. Pure function; uses the caller's TBB arena. Pipeline: frame → **order** → surface, octree.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "renderer/cloud/point_batch.hpp"
#include "renderer/cloud/sample.hpp"

namespace scancast {

/// A point with all that its sample needs: columns stand far apart in memory, and each would be fetched by itself.
struct FramePoint {
    glm::dvec3 position{0};  ///< cloud-relative
    std::array<std::uint8_t, 3> color{255, 255, 255};
    std::uint8_t classification = 0;
    std::uint16_t intensity = 0;
    std::uint16_t normal = noNormal;  ///< the frame's own, as in Sample
};
static_assert(sizeof(FramePoint) == 32);

struct FrameOrder {
    static constexpr int bits = 21;  ///< of a cell's index, per axis

    std::vector<std::uint64_t> keys;  ///< Morton keys of the cells of level 0, ascending
    std::vector<FramePoint> points;   ///< in that order; those of one cell in the frame's
    glm::dvec3 low{0};                ///< corner of the cell 0, 0, 0, cloud-relative
    double step = 1;                  ///< side of a cell of level 0; of level n: 2^n times that

    std::size_t size() const { return keys.size(); }
    /// How many cells of each level, 0 … bits, these positions of the order occupy.
    std::array<std::uint32_t, bits + 1> cellCounts(std::size_t begin, std::size_t end) const;
};

/// The key of a cell, and back.
std::uint64_t frameKey(const std::array<std::uint32_t, 3>& cell);
std::array<std::uint32_t, 3> cellOfKey(std::uint64_t key);
/// The lowest level at which both keys are in one cell.
constexpr int commonLevel(std::uint64_t a, std::uint64_t b) {
    return (int(std::bit_width(a ^ b)) + 2) / 3;
}

/// `bounds` hold all positions, which are finite; file coordinates, as is the cloud's origin.
FrameOrder orderFrame(const PointBatch& points, const std::array<glm::dvec3, 2>& bounds,
                      const glm::dvec3& origin);

}  // namespace scancast
