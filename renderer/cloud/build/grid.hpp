// The integer grid on which an octree is built, and the point as it stands there.
// Pipeline: import → **grid** → octree builder. Plain values.
//
// All of the builder's arithmetic on positions is on integers: sums are exact, so the octree does not depend
// on the order in which threads add. A scan that has a grid of its own (LAS) keeps it; a floating-point scan
// gets a cubic one of a power of two, fine enough that 32-bit floats survive.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

inline constexpr int gridBits =
    42;  ///< of a position, per axis: an outlier a billion metres away leaves 0.2 mm

/// Position in grid steps, each < 2^gridBits.
using GridPosition = std::array<std::uint64_t, 3>;

struct GridBox {
    GridPosition min{~std::uint64_t(0), ~std::uint64_t(0), ~std::uint64_t(0)};
    GridPosition max{0, 0, 0};

    void add(const GridBox& b) {
        for (int a = 0; a < 3; ++a) {
            min[a] = std::min(min[a], b.min[a]);
            max[a] = std::max(max[a], b.max[a]);
        }
    }
    void add(const GridPosition& p) { add(GridBox{p, p}); }
    bool isPoint() const { return min == max; }
};

/// File coordinate = corner + step * integer.
struct Grid {
    glm::dvec3 corner{0};
    glm::dvec3 step{1};
    /// The scan's own grid is 2^ownShift steps on that axis: axes of unlike grids (centimetres and
    /// millimetres, degrees and metres) are brought within a factor of √2 of each other by whole bits.
    std::array<int, 3> ownShift{0, 0, 0};

    glm::dvec3 toFile(const GridPosition& p) const {
        return corner + step * glm::dvec3(double(p[0]), double(p[1]), double(p[2]));
    }
    /// The cube of 2^cellLevel steps, as one length.
    double cellSize(int cellLevel) const;
};

/// A grid for integers from `low` to `high` of the scan's own grid, whose 0 lies at `origin`.
Grid ownGrid(const glm::dvec3& origin, const glm::dvec3& ownStep, const std::array<std::int64_t, 3>& low,
             const std::array<std::int64_t, 3>& high);
/// A cubic grid over a box in file coordinates.
Grid cubicGrid(const glm::dvec3& low, const glm::dvec3& high);

/// A cloud's origin: the minimum corner, rounded down to a power of ten not above the cloud's size: short to write, and
/// exact.
glm::dvec3 roundOrigin(const std::array<glm::dvec3, 2>& bounds);

/// What averages need to know of a density (Density), in two bits: a sample of points most of which are edges
/// is a surface's.
enum class Bulk : std::uint8_t { Surface, Wire, Foliage, Stray };

/// A scan point while the octree is built: 24 bytes.
struct BuildPoint {
    std::array<std::uint32_t, 3> low{};  ///< the lower 32 bits of the position
    std::uint32_t high = 0;              ///< the upper 10 bits of each axis: x lowest; above them a bulk
    std::uint16_t intensity = 0;
    std::array<std::uint8_t, 3> color{255, 255, 255};
    std::uint8_t classification = 0;
    std::uint16_t normal = 0;  ///< as in Sample

    std::uint64_t axis(int a) const { return low[a] | std::uint64_t(high >> (10 * a) & 1023u) << 32; }
    GridPosition position() const { return {axis(0), axis(1), axis(2)}; }
    Bulk bulk() const { return Bulk(high >> 30); }
    void setBulk(Bulk b) { high = (high & 0x3fffffffu) | std::uint32_t(b) << 30; }
    /// Its bulk becomes a surface's.
    void setPosition(const GridPosition& p) {
        low = {std::uint32_t(p[0]), std::uint32_t(p[1]), std::uint32_t(p[2])};
        high = std::uint32_t(p[0] >> 32 | (p[1] >> 32) << 10 | (p[2] >> 32) << 20);
    }
};
static_assert(sizeof(BuildPoint) == 24 && gridBits == 42);

}  // namespace scancast
