// Builds the octree of a cloud from points on a grid, in parallel: split at the average until leaves are
// small, then average upwards. Source: 001_c3e54385a9f0e90c, Algorithm 1; design methods.md §6. Pipeline:
// staging → **octree builder** → octree. Called once per cloud, on any thread; uses the caller's TBB arena.
//
// The result depends on the set of points alone: neither on threads nor on the order of the points.
#pragma once

#include <span>

#include "renderer/cloud/grid.hpp"
#include "renderer/cloud/octree.hpp"
#include "renderer/progress.hpp"

namespace scancast {

struct OctreeInput {
    std::span<BuildPoint> points;  ///< at least one; they are reordered
    Grid grid;
    glm::dvec3 origin{0};  ///< the cloud's, file coordinates
    Attributes attributes;
    std::uint32_t leafPoints = 16384;
};

/// Reports the stages "sorting" and "averaging".
Octree buildOctree(const OctreeInput& input, const ProgressSink& progress);

}  // namespace scancast
