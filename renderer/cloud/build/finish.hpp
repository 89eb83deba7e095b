// The last step of building: nodes get their numbers, inner nodes their surfels, everything its normal cone;
// inner samples go to the file, or all samples side by side in memory. Pipeline: filled tree → **finish** →
// octree.
#pragma once

#include "renderer/cloud/build/octree_builder.hpp"
#include "renderer/cloud/build/value_sketch.hpp"

namespace scancast {

/// Breadth first. Leaves are in the file already, where there is one. Errors: the file's and the workspace's;
/// Cancelled. It is what follows, one after the other; several processes do the second each for its own nodes.
Expected<BuiltOctree> finishTree(BuildNode& root, const OctreeInput& input, BlockSink* file,
                                 const ProgressSink& progress, const std::stop_token& stop);

/// Inner nodes from the root down, level after level: the order of their blocks in a file.
std::vector<BuildNode*> innerNodes(BuildNode& root);

/// Of a node whose subtree is grown, from where they wait: set aside - a node that is kept elsewhere has there what was fetched of it
/// -, else in the file.
Expected<std::vector<Sample>> samplesOf(const BuildNode& node, const BlockSink* file);

/// Surfels, cones, hashes and blocks of some inner nodes, in parallel, and, without a file, their samples. Neighbours' samples are read
/// where they wait: set aside, or in the file. `curvatures` gets what is seen of the whole cloud.
Expected<void> finishInnerNodes(std::span<BuildNode* const> nodes, const BuildNode& root,
                                const OctreeInput& input, BlockSink* file, ValueSketch& curvatures,
                                const ProgressSink& progress, const std::stop_token& stop);

/// The curvatures of a cloud that is one leaf: it has no inner nodes.
Expected<void> addLeafCurvatures(const BuildNode& leaf, const OctreeInput& input, const BlockSink* file,
                                 ValueSketch& curvatures);

/// All nodes are finished: their numbers and joined cones; samples side by side, unless they are in a file.
BuiltOctree numberTree(BuildNode& root, const OctreeInput& input, bool inFile, const ValueSketch& curvatures);

/// What revisions know a node's samples by, and what stands beside them, if anything.
std::uint64_t hashOf(std::span<const Sample> samples, std::span<const BesideWord> beside);

/// What stands beside a node's samples, as blocks of planes; empty where all of it is 0, or there is none.
struct BesideBlocks {
    std::vector<std::byte> curvature, nearInfrared;
};
BesideBlocks encodeBeside(std::span<const BesideWord> beside, const OctreeInput& input);
/// Of nothing where a block is empty. Errors: the file's.
Expected<BesidePlaces> appendBlocks(BlockSink& file, const BesideBlocks& blocks);
/// Kept columns, the positions that samples round, the curvature and the near infrared.
inline std::size_t planesOf(const OctreeInput& input) {
    return input.columns.size() + (input.gridPlanes ? 3 : 0) + (input.shape.curvatures() ? 1 : 0) +
           (input.nearInfrared ? 1 : 0);
}

/// Around the samples' own normals.
NormalCone coneOfSamples(std::span<const Sample> samples);

}  // namespace scancast
