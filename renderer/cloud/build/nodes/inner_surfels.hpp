// Surfels of inner nodes: radius and axes estimated anew among the samples of one level, across node borders
// (averaged radii would leave holes two levels up). Pipeline: filled tree → **inner surfels** → finished
// samples. Source: docs/spec/hierarchy.md §3.
#pragma once

#include <functional>
#include <vector>

#include "renderer/cloud/build/octree_builder.hpp"

namespace scancast {

/// The nodes of an inner node's level - where the tree is not as deep, the leaves - near its box: whose samples its surfels depend on.
std::vector<const BuildNode*> neighboursOf(const BuildNode& node, const BuildNode& root);

/// A node's samples, wherever they are.
using SamplesOf = std::function<Expected<std::vector<Sample>>(const BuildNode&)>;

/// What averaging knows of an inner node's samples beside what they hold.
struct AveragedFacts {
    std::vector<float> reaches;      ///< cloud units to the farthest position averaged
    std::vector<Density> densities;  ///< what most of the points are
};

/// Sets radius and ellipse of an inner node's samples, the normal of those that have none, and, with curvatures,
/// the curvature in the words beside them. Neighbours are
/// neighboursOf() it. Thread-safe. Errors:
/// samplesOf's.
Expected<void> addInnerSurfels(const BuildNode& node, const AveragedFacts& facts, const BuildNode& root,
                               const OctreeInput& input, const SamplesOf& samplesOf,
                               std::span<Sample> samples, std::span<BesideWord> beside);

}  // namespace scancast
