// What a chunk's subtree keeps while it waits for all others: its leaves' surfels in eight bytes a point, and the
// facets and patches that sides are decided by. Pipeline: leaves with surfels → **held** → sides → leaves again.
// Source: docs/spec/surfels.md §9.
#pragma once

#include "renderer/cloud/build/nodes/build_node.hpp"
#include "renderer/cloud/build/octree_builder.hpp"
#include "renderer/cloud/build/sides/decide_sides.hpp"
#include "renderer/cloud/build/sides/facet.hpp"
#include "renderer/cloud/surfels/patches.hpp"

namespace scancast {

struct ChunkSides {
    Workspace::Buffer surfels;  ///< HeldSurfel of each point, in the tree's order
    std::vector<Facet> facets;  ///< patches count from 0
    std::vector<PatchCount> patches;
    std::vector<Border> borders;
};

/// The leaves' samples are given up: they are made again of the points and this.
Expected<ChunkSides> holdSides(BuildNode& root, const SidePatches& patches, const OctreeInput& input,
                               Workspace& workspace);

/// Makes the leaves below a root again, whose points are back in memory: samples, turned to the sides that were
/// found, and the points' normals. `firstPatch`: what number the chunk's first patch has in the whole cloud.
/// Errors: the workspace's.
Expected<void> takeSides(BuildNode& root, const ChunkSides& held, const Sides& sides,
                         std::uint32_t firstPatch, const OctreeInput& input);

}  // namespace scancast
