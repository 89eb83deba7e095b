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

/// What revisions know a node's samples by, and the curvatures beside them, if any.
std::uint64_t hashOf(std::span<const Sample> samples, std::span<const CurvatureCode> curvatures);

/// A node's plane of curvatures as a block; empty where all of it is flat, or there is none.
std::vector<std::byte> encodeCurvatures(std::span<const CurvatureCode> curvatures);
/// Of nothing where the block is empty. Errors: the file's.
Expected<BlockPlace> appendBlock(CloudFileWriter& file, std::span<const std::byte> block);
/// Kept columns, the positions that samples round, and the curvature.
inline std::size_t planesOf(const OctreeInput& input) {
    return input.columns.size() + (input.gridPlanes ? 3 : 0) + (input.shape.curvatures() ? 1 : 0);
}

/// Around the samples' own normals.
NormalCone coneOfSamples(std::span<const Sample> samples);

}  // namespace scancast
