// Surfels of the samples that a native cloud draws of one voxel, estimated among those alone: the same whenever they are read. Normals
// are of either side; at a voxel's border, neighbours beyond it are not known. Uses the caller's TBB arena.
// Pipeline: raw points → samples → **surfels** → block.
#pragma once

#include <span>

#include "renderer/cloud/octree.hpp"

namespace scancast {

/// Sets normal, radius and ellipse of all of a node's samples, which are in Morton order.
void addNodeSurfels(const Node& node, std::span<Sample> samples);

}  // namespace scancast
