// What is to be built, decided once all points have been seen: the cloud's facts, its grid, and what the octree builder needs to know.
// Pipeline: staging → **plan** → chunks, octree. Pure functions of what was staged and the shape.
#pragma once

#include "renderer/cloud/build/chunks/staging.hpp"
#include "renderer/cloud/build/octree_builder.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Whether normals will be estimated that may have to be turned to where each point was recorded from.
bool wantsSights(const ScanHeader& header, const OctreeShape& shape);

struct BuildPlan {
    CloudFacts facts;   ///< all but what only the finished octree knows
    OctreeInput input;  ///< with the grid
    GridBox box;        ///< of the scan on it: exact on its own grid, else a step larger at most
};

/// `header`: as it stands after reading. Errors: Malformed for what cannot be kept exactly.
Expected<BuildPlan> planBuild(const StagedScan& scan, const ScanHeader& header, const OctreeShape& shape);

/// What the finished octree adds.
void completeFacts(CloudFacts& facts, const OctreeInput& input, const BuiltOctree& octree);

}  // namespace scancast
