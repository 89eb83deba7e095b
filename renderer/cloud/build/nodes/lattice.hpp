// The 16-bit lattice that a node's sample positions lie on, and the node's bounds. Pure values of the
// builder.
#pragma once

#include <span>

#include "renderer/cloud/build/grid.hpp"
#include "renderer/cloud/octree.hpp"

namespace scancast {

/// A leaf's lattice: the scan's own grid where 16 bits reach, else the finest power of two of it that they do
/// reach; anchored globally.
struct LeafLattice {
    std::array<int, 3> shift{};  ///< lattice step = grid step << shift
    GridPosition first{};        ///< index of the lattice plane that samples count from
    glm::dvec3 corner{0};  ///< where that is, cloud-relative; half a step in where positions are rounded
    glm::dvec3 step{1};
    bool exact = true;  ///< on the scan's own grid

    std::array<std::uint16_t, 3> quantise(const BuildPoint& p) const {
        const auto q = [&](int a) { return std::uint16_t((p.axis(a) >> shift[a]) - first[a]); };
        return {q(0), q(1), q(2)};
    }
};
/// `origin` is the cloud's.
LeafLattice leafLattice(const GridBox& box, const Grid& grid, const glm::dvec3& origin);

/// An inner node's lattice over a box that is cloud-relative already: steps are a power of two of the grid's,
/// at most 256 times finer, for averages lie between grid positions.
struct InnerLattice {
    glm::dvec3 corner{0};
    glm::dvec3 step{1};
    int cellLevel = 0;  ///< of the coarsest axis: step = grid step · 2^cellLevel

    std::array<std::uint16_t, 3> quantise(const glm::dvec3& p) const;
};
InnerLattice innerLattice(const glm::dvec3& low, const glm::dvec3& high, const Grid& grid);

/// Box and sphere. The sphere stands around the box's middle.
struct Bounds {
    glm::dvec3 low{1e300}, high{-1e300}, center{0};
    double radius = 0;
};
/// Of samples on a lattice and of children's bounds; either may be empty.
Bounds boundsOf(std::span<const Sample> samples, const glm::dvec3& corner, const glm::dvec3& step,
                std::span<const Bounds> below);

}  // namespace scancast
