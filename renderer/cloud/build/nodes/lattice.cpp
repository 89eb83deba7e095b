#include "renderer/cloud/build/nodes/lattice.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace scancast {

LeafLattice leafLattice(const GridBox& box, const Grid& grid, const glm::dvec3& origin) {
    LeafLattice lattice;
    for (int a = 0; a < 3; ++a) {
        int& k = lattice.shift[a];
        k = grid.ownShift[a];
        while ((box.max[a] >> k) - (box.min[a] >> k) > 65535) ++k;
        const bool rounds = k > grid.ownShift[a];
        lattice.exact = lattice.exact && !rounds;
        lattice.first[a] = box.min[a] >> k;
        const double half = rounds ? std::ldexp(0.5, k) : 0.0;
        lattice.step[a] = std::ldexp(grid.step[a], k);
        lattice.corner[a] =
            grid.corner[a] - origin[a] + grid.step[a] * (double(lattice.first[a] << k) + half);
    }
    return lattice;
}

std::array<std::uint16_t, 3> InnerLattice::quantise(const glm::dvec3& p) const {
    const auto q = [&](int a) {
        return std::uint16_t(std::clamp(std::floor((p[a] - corner[a]) / step[a] + 0.5), 0.0, 65535.0));
    };
    return {q(0), q(1), q(2)};
}

InnerLattice innerLattice(const glm::dvec3& low, const glm::dvec3& high, const Grid& grid) {
    InnerLattice lattice;
    lattice.corner = low;
    lattice.cellLevel = -8;
    for (int a = 0; a < 3; ++a) {
        int k = -8;
        while (std::ldexp(grid.step[a], k) * 65535 < high[a] - low[a]) ++k;
        lattice.step[a] = std::ldexp(grid.step[a], k);
        lattice.cellLevel = std::max(lattice.cellLevel, k);
    }
    return lattice;
}

Bounds boundsOf(std::span<const Sample> samples, const glm::dvec3& corner, const glm::dvec3& step,
                std::span<const Bounds> below) {
    Bounds b;
    const auto at = [&](const Sample& s) { return corner + step * glm::dvec3(s.x, s.y, s.z); };
    for (const Sample& s : samples) {
        const glm::dvec3 p = at(s);
        b.low = glm::min(b.low, p);
        b.high = glm::max(b.high, p);
    }
    for (const Bounds& child : below) {
        b.low = glm::min(b.low, child.low);
        b.high = glm::max(b.high, child.high);
    }
    b.center = (b.low + b.high) * 0.5;
    double squared = 0, reach = 0;
    for (const Sample& s : samples) {
        const glm::dvec3 d = at(s) - b.center;
        squared = std::max(squared, glm::dot(d, d));
    }
    for (const Bounds& child : below)
        reach = std::max(reach, glm::length(child.center - b.center) + child.radius);
    const double exact = std::min(std::max(std::sqrt(squared), reach), glm::length(b.high - b.low) * 0.5);
    b.radius = exact * (1 + 1e-12);
    return b;
}

}  // namespace scancast
