// Builds the octree of a cloud from chunks of points on a grid, in parallel: split at the average until
// leaves are small, then average upwards; last of all, what inner nodes need to know of their neighbours.
// Source: Kaushik, Nagwanshi and Sharma, "Achieving a Smooth Interpolation between the Points Using Modified
// Rendering Algorithm", undated, §IV-a; docs/spec/hierarchy.md §2. Pipeline: chunks → **octree builder** →
// octree or cloud file. Called once per cloud, on any thread; uses the caller's TBB arena.
//
// The result depends on the set of points and the shape alone: neither on threads nor on memory nor on the
// order of the points.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "renderer/cloud/build/chunks/chunks.hpp"
#include "renderer/cloud/build/grid.hpp"
#include "renderer/cloud/build/octree_shape.hpp"
#include "renderer/cloud/build/sides/decide_sides.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_place.hpp"
#include "renderer/cloud/file/block_sink.hpp"
#include "renderer/cloud/file/blocks/row_columns.hpp"

namespace scancast {

/// Where each point's near infrared stands in its row, a uint16 of which 8 bits are left after a shift.
struct InfraredInRow {
    PlaceInRow place;
    int shift = 0;
};

struct OctreeInput {
    Grid grid;
    glm::dvec3 origin{0};     ///< the cloud's, file coordinates
    Attributes attributes;    ///< that samples will have; with surfels, always a normal
    bool ownNormals = false;  ///< the scan's normals are kept
    bool oriented = false;    ///< the normals' sides are known from the start
    bool findSides = false;   ///< they are to be found, when all points have normals
    bool upIsZ = false;       ///< the scan says so: it has coordinates of the earth, or a format of surveyors
    std::optional<glm::dvec3> scanner;  ///< cloud-relative: estimated normals point to it
    /// Points bring, in the place of a normal, the direction to the scanner that saw them: estimated normals point there.
    bool sights = false;
    OctreeShape shape;
    std::vector<PlaceInRow> columns;  ///< that are kept
    std::optional<InfraredInRow> nearInfrared;
    std::size_t rowBytes = 0;              ///< of all of these
    bool gridPlanes = false;               ///< positions on the scan's grid are kept where samples round them
    std::array<std::int64_t, 3> ownLow{};  ///< the scan's whole numbers at the grid's corner

    /// Samples have words beside them (renderer/cloud/sample.hpp).
    bool hasBeside() const { return shape.curvatures() || nearInfrared; }
};

/// A finished octree: in a file, or with its samples in memory.
struct BuiltOctree {
    std::vector<StoredNode> nodes;   ///< breadth first; places are set where there is a file
    std::vector<BlockPlace> planes;  ///< of all planes in the file, node by node: columns, then companions
    std::vector<std::uint64_t>
        sampleHashes;                ///< XXH3, 64 bits, of each node's samples and what stands beside them
    std::vector<Sample> samples;     ///< of all nodes in turn; empty where there is a file
    std::vector<BesideWord> beside;  ///< likewise; empty where nothing stands beside them
    std::array<double, 2> usualCurvature{};  ///< mean curvature: its 5th and 95th percentile, 1 / cloud units
    double sure = 0;                         ///< share of the points in leaves of at least sureSide
};

/// `root` is the tree's top as divide() grew it; chunks are used up. With a file, blocks are appended to it:
/// leaves in the order of the tree, then inner nodes from the root down. `lanes`: chunks in memory at once.
/// Reports the stages "building" (points) and "finishing" (nodes). Errors: the workspace's and the file's;
/// Cancelled.
Expected<BuiltOctree> buildOctree(BuildNode& root, std::vector<Chunk> chunks, const OctreeInput& input,
                                  int lanes, Workspace& workspace, BlockSink* file,
                                  const ProgressSink& progress, const std::stop_token& stop);

/// Points in finished leaves, and those of them whose side is sure.
struct SureCount {
    std::uint64_t points = 0, sure = 0;
    double share() const { return points ? double(sure) / double(points) : 0; }
};
/// The sides of these patches, whoever else has some: decideSides(), or what several processes agree on; these have to hear of it
/// where leaves could not be `grown`. Facets are used up.
using SidesOfPatches =
    std::function<Expected<Sides>(const Expected<void>& grown, std::vector<Facet>& facets,
                                  std::span<const PatchCount> patches, std::span<const Border> borders)>;

/// The first of buildOctree()'s two steps - the other is finishTree() -, for some of the cloud's chunks, in the order of the tree: their
/// subtrees, and the nodes above whose children are all there. `sides` is asked once, where input.findSides.
Expected<SureCount> growTree(std::vector<Chunk> chunks, const OctreeInput& input, int lanes,
                             Workspace& workspace, BlockSink* file, const SidesOfPatches& sides,
                             const ProgressSink& progress, const std::stop_token& stop);

/// Memory that a node of a tree in a file takes until the end, beside what waits in the workspace.
std::uint64_t bytesOfNode(const OctreeInput& input);

/// A node is finished, but for what its neighbours have to say: fills the nodes above whose children are then all there. `inFile`:
/// samples wait in the workspace, as growTree() has it with a file. Errors: the workspace's.
Expected<void> averageUpwards(BuildNode& from, const OctreeInput& input, Workspace& workspace, bool inFile);

}  // namespace scancast
