// The facets of one leaf. Pipeline: leaf with surfels → **facets** → sides. Pure function.
#pragma once

#include <span>

#include "renderer/cloud/build/nodes/build_node.hpp"
#include "renderer/cloud/build/sides/facet.hpp"

namespace scancast {

/// Of the leaf's points in Morton order: those of one patch in one cell. `patches` are the points', 0 = none;
/// facets count them from `firstPatch`.
std::vector<Facet> facetsOf(const BuildNode& leaf, std::span<const std::uint16_t> patches, const Grid& grid,
                            const glm::dvec3& origin);

}  // namespace scancast
