// An octree whose nodes *add* to their parents, as COPC's do, seen as one whose nodes *replace* them (renderer/cloud/octree.hpp): what is
// drawn of a voxel is its own points and those of all voxels above that lie in it. An octant of a voxel that has others below it, but
// not there, is a leaf: of the voxels above alone. So every level shows the whole scan, each point once, and the leaves together are
// all its points. Pure functions. Pipeline: hierarchy → **additive tree** → native cloud.
//
// How many of the points above lie in a voxel is not known before they are decoded: Node::sampleCount and Node::points of all
// nodes but the root are estimates, functions of the hierarchy alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/cloud/file/block_place.hpp"
#include "renderer/cloud/native/voxel_tree.hpp"
#include "renderer/cloud/positions.hpp"

namespace scancast {

/// Where a node's samples are on the scan's grid: sample = (number - low) >> shift, rounded; on every axis.
struct NodeLattice {
    std::array<std::int64_t, 3> low{};
    std::array<std::uint8_t, 3> shift{};
};

struct AdditiveNode {
    VoxelKey key;
    std::uint32_t voxel = noVoxel;  ///< whose own points it has; noVoxel: those above alone
    NodeLattice lattice;
};

struct AdditiveTree {
    std::vector<StoredNode> nodes;  ///< breadth first
    std::vector<AdditiveNode> own;  ///< one each
};

/// How dense the points of the root are, cloud units; > 0.
struct RootSpacing {
    double mean = 1, closing = 1;
};

struct AdditiveFrame {
    VoxelCube cube;                    ///< the cube
    StepGrid grid;                     ///< of the points
    glm::dvec3 origin;                 ///< the cloud's
    std::array<glm::dvec3, 2> bounds;  ///< of all points, file coordinates, as the file has them
    RootSpacing spacing;
};

/// The octant that a point lies in, in whole numbers of the grid: points on the middle belong to the upper half.
class Octants {
  public:
    Octants(const AdditiveFrame& frame, const VoxelKey& key);
    int of(const GridSteps& point) const {
        return int(double(point[0]) >= middle_.x) | int(double(point[1]) >= middle_.y) << 1 |
               int(double(point[2]) >= middle_.z) << 2;
    }

  private:
    glm::dvec3 middle_;
};

/// Errors: Malformed, where cube and grid do not go together; ResourceLimit.
Expected<AdditiveTree> additiveTree(const VoxelTree& hierarchy, const AdditiveFrame& frame);

}  // namespace scancast
