// The last step of building: nodes get their numbers, inner nodes their surfels, everything its normal cone;
// inner samples go to the file, or all samples side by side in memory. Pipeline: filled tree → **finish** →
// octree.
#pragma once

#include "renderer/cloud/build/octree_builder.hpp"

namespace scancast {

/// Breadth first. Leaves are in the file already, where there is one. Errors: the file's and the workspace's;
/// Cancelled.
Expected<BuiltOctree> finishTree(BuildNode& root, const OctreeInput& input, CloudFileWriter* file,
                                 const ProgressSink& progress, const std::stop_token& stop);

/// Around the samples' own normals.
NormalCone coneOfSamples(std::span<const Sample> samples);

}  // namespace scancast
