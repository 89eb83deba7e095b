#include "renderer/cloud/build/sides/leaf_facets.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "renderer/cloud/surfels/patches.hpp"

namespace scancast {

namespace {

/// Points of a cell, about: enough to be few, few enough to follow what a town's houses are made of. Small leaves
/// have fewer in each.
constexpr std::uint64_t pointsInCell = 64, leastInCell = 16, cellsOfSmallLeaf = 256;
/// A facet of fewer says nothing that its neighbours do not.
constexpr std::uint32_t leastInFacet = 4;

/// What is summed for one patch in one cell.
struct FacetSum {
    std::uint16_t patch = noPatch;
    std::uint32_t points = 0;
    glm::dvec3 position{0};
    glm::vec3 normal{0};
};

class CellFacets {
  public:
    CellFacets(const BuildNode& leaf, const Grid& grid, const glm::dvec3& origin)
        : leaf_(leaf), grid_(grid), base_(grid.toFile(leaf.box.min) - origin) {
        const double spacing = leaf.content.meanSpacing;
        areaOfPoint_ = float(spacing * spacing);
    }

    void add(const BuildPoint& p, std::uint16_t patch) {
        auto sum =
            std::find_if(sums_.begin(), sums_.end(), [&](const FacetSum& s) { return s.patch == patch; });
        if (sum == sums_.end()) sum = sums_.insert(sums_.end(), {.patch = patch});
        ++sum->points;
        for (int a = 0; a < 3; ++a) sum->position[a] += double(p.axis(a) - leaf_.box.min[a]);
        sum->normal += decodeNormal(p.normal);
    }

    void flush(std::vector<Facet>& out) {
        for (const FacetSum& s : sums_) {
            const float length = std::sqrt(glm::dot(s.normal, s.normal));
            if (s.points < leastInFacet || !(length > 0)) continue;
            out.push_back({.position = glm::vec3(base_ + s.position / double(s.points) * grid_.step),
                           .normal = s.normal / length,
                           .area = areaOfPoint_ * float(s.points),
                           .patch = s.patch == noPatch ? loosePoints : std::uint32_t(s.patch - 1)});
        }
        sums_.clear();
    }

  private:
    const BuildNode& leaf_;
    const Grid& grid_;
    glm::dvec3 base_;
    float areaOfPoint_ = 0;
    std::vector<FacetSum> sums_;
};

}  // namespace

std::vector<Facet> facetsOf(const BuildNode& leaf, std::span<const std::uint16_t> patches, const Grid& grid,
                            const glm::dvec3& origin) {
    std::vector<Facet> out;
    const std::uint64_t most = std::max<std::uint64_t>(
        {1, leaf.points.size() / pointsInCell, std::min(leaf.points.size() / leastInCell, cellsOfSmallLeaf)});
    int cellLevel = leaf.content.cellLevel;
    while (cellLevel < gridBits && leaf.content.cells.cells(cellLevel) > most) ++cellLevel;
    const auto cellOf = [&](const BuildPoint& p) {
        const GridPosition q = p.position();
        return GridPosition{q[0] >> cellLevel, q[1] >> cellLevel, q[2] >> cellLevel};
    };
    CellFacets cell(leaf, grid, origin);
    GridPosition last = cellOf(leaf.points.front());
    for (std::size_t i = 0; i < leaf.points.size(); ++i) {
        if (const GridPosition here = cellOf(leaf.points[i]); here != last) {
            cell.flush(out);
            last = here;
        }
        cell.add(leaf.points[i], patches[i]);
    }
    cell.flush(out);
    return out;
}

}  // namespace scancast
