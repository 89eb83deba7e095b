// A leaf: the scan's own points in Morton order, quantised. Pipeline: splitter → **leaf** → averages.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "renderer/cloud/beside.hpp"
#include "renderer/cloud/build/morton.hpp"
#include "renderer/cloud/build/nodes/lattice.hpp"
#include "renderer/cloud/density.hpp"

namespace scancast {

/// What the builder knows of a node that is finished but for its place in the octree.
struct NodeContent {
    glm::dvec3 corner{0}, step{1};
    Bounds bounds;
    double spacing = 0;      ///< closes the surface; 0 = not known: one sample, or all at one place
    double meanSpacing = 0;  ///< √(surface per sample); 0 = not known
    int cellLevel = 0;       ///< coarser nodes may merge samples in cells of 2^cellLevel steps and larger
    CellCount cells;
    std::vector<Sample> samples;
    std::vector<float> reaches;  ///< of an inner node's samples, with surfels: Average::reach
    std::vector<Density>
        densities;  ///< of its samples, with surfels; Surface, Wire, Foliage or Stray of averages
    std::vector<BesideWord> beside;  ///< of its samples, where anything stands beside them
    NormalCone cone;                 ///< of the node's own samples
};

/// What a node's radii count from (Node::radiusUnit).
inline float radiusUnit(double spacing) {
    return std::max(float(spacing), std::numeric_limits<float>::min());
}

/// Sorts the points in place into an order that depends only on what they are, and makes a leaf of them.
/// Nothing, when 16 bits an axis are too coarse for points this close together: the set has to be split
/// further.
std::optional<NodeContent> makeLeaf(std::span<BuildPoint> points, const GridBox& box, const Grid& grid,
                                    const glm::dvec3& origin);

/// The samples of a leaf's sorted points; all but surfels.
std::vector<Sample> leafSamples(std::span<const BuildPoint> points, const LeafLattice& lattice);

/// Whether the samples of a leaf have its points' positions exactly.
bool isExact(const GridBox& box, const Grid& grid);

/// The largest leaf: 16 bits of the sorting key hold the point's number. Only equal points may be more.
inline constexpr std::uint32_t mostLeafPoints = 65536;

}  // namespace scancast
