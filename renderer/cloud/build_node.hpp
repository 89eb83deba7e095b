// A node while the octree grows: owned by its parent, worked on by one task at a time.
#pragma once

#include <memory>

#include "renderer/cloud/average.hpp"
#include "renderer/cloud/leaf.hpp"
#include "renderer/cloud/octree_builder.hpp"
#include "renderer/cloud/progress_meter.hpp"

namespace scancast {

struct BuildNode {
    std::span<BuildPoint> points;  ///< everything below
    GridBox box;
    int level = 0;
    NodeContent content;
    AverageList averages;  ///< of an inner node, until its parent has used it
    std::vector<std::unique_ptr<BuildNode>> children;

    bool isLeaf() const { return children.empty(); }
};

/// Splits a node into leaves and finishes those.
void grow(BuildNode& node, const OctreeInput& input, ProgressMeter& progress);

/// Fills the inner nodes, children first.
void fillInner(BuildNode& node, const OctreeInput& input, ProgressMeter& progress);

/// Puts finished nodes side by side in breadth-first order; takes their samples.
Octree flatten(BuildNode& root, const Grid& grid);

}  // namespace scancast
