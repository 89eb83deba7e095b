// The subtree of one chunk: grown down to leaves, then averaged upwards; and single inner nodes above chunks.
// Pipeline: chunk → **subtree** → octree builder. Use the caller's TBB arena.
#pragma once

#include "renderer/cloud/build/nodes/build_node.hpp"
#include "renderer/cloud/build/octree_builder.hpp"
#include "renderer/cloud/surfels/patches.hpp"

namespace scancast {

/// Splits a node's points into leaves and finishes those, but for surfels.
void grow(BuildNode& node, const OctreeInput& input);

/// Estimates the surfels of all leaves below a chunk's root; `halo` are points of other chunks nearby. Puts
/// them into samples, and the normals into the points, so that they are averaged. Where sides are to be found, the
/// normals of each of the patches point to one side.
SidePatches addLeafSurfels(BuildNode& root, std::span<const BuildPoint> halo, const OctreeInput& input);

/// Fills the inner nodes below and including this one, children first.
void fillBelow(BuildNode& node, const OctreeInput& input);

/// Fills one inner node whose children are finished.
void fillInner(BuildNode& node, const OctreeInput& input);

/// In the order of a walk depth first, parents before children.
template <class Visit>
void forEachNode(BuildNode& node, Visit visit) {
    visit(node);
    for (auto& child : node.children) forEachNode(*child, visit);
}

}  // namespace scancast
