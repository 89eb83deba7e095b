#include "renderer/cloud/native/additive_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace scancast {

namespace {

// Some 500 bytes each: half a gigabyte, of a scan of some ten billion points.
constexpr std::size_t mostNodes = 1 << 20;
// Points may lie a little outside their voxel, by the rounding of whoever wrote them.
constexpr double margin = 0.125, marginSteps = 16;
// No grid has numbers that float64 does not tell apart.
constexpr double farthestStep = 0x1p52;
constexpr std::int64_t mostInSample = 65535;
// An octant that nobody went on with has few of its parent's points.
constexpr double shareOfEmptyOctant = 1.0 / 64;

glm::dvec3 cornerOf(const VoxelCube& cube, const VoxelKey& key) {
    const double side = std::ldexp(2 * cube.halfSize, -key.level);
    return cube.center - cube.halfSize + side * glm::dvec3(key.at[0], key.at[1], key.at[2]);
}

class Planting {
  public:
    Planting(const VoxelTree& hierarchy, const AdditiveFrame& frame) : hierarchy_(hierarchy), frame_(frame) {}

    Expected<AdditiveTree> run() {
        if (auto ok = checkFrame(); !ok) return passOn(ok);
        const Voxel& root = hierarchy_.voxels.front();
        add(root.key, 0, noNode, double(root.points));
        for (std::uint32_t i = 0; i < tree_.nodes.size(); ++i) {
            branch(i);
            if (tree_.nodes.size() > mostNodes)
                return fail(ErrorCode::ResourceLimit,
                            fmt::format("its octree has more than {} nodes, and is not shown as it is{}",
                                        mostNodes, ingestInstead));
        }
        std::uint64_t first = 0;
        for (StoredNode& stored : tree_.nodes) {
            stored.node.firstSample = first;
            first += stored.node.sampleCount;
        }
        return std::move(tree_);
    }

  private:
    Expected<void> checkFrame() const {
        for (int a = 0; a < 3; ++a) {
            const double center = (frame_.cube.center[a] - frame_.grid.origin[a]) / frame_.grid.step[a];
            const double reach = 4 * frame_.cube.halfSize / frame_.grid.step[a];
            if (std::abs(center) + reach < farthestStep) continue;
            return fail(ErrorCode::Malformed, "the cube of its octree is larger than its points can reach");
        }
        return {};
    }

    void branch(std::uint32_t at) {
        if (tree_.own[at].voxel == noVoxel) return;
        const VoxelKey key = tree_.own[at].key;
        if (key.level >= deepestVoxel) return;
        std::array<std::uint32_t, 8> below{};
        std::uint64_t points = 0;
        for (int octant = 0; octant < 8; ++octant) {
            below[std::size_t(octant)] = hierarchy_.find(key.child(octant));
            if (below[std::size_t(octant)] != noVoxel)
                points += hierarchy_.voxels[below[std::size_t(octant)]].below;
        }
        if (points == 0) return;
        const double above = tree_.nodes[at].node.sampleCount;
        tree_.nodes[at].node.firstChild = std::uint32_t(tree_.nodes.size());
        tree_.nodes[at].node.childCount = 8;
        for (int octant = 0; octant < 8; ++octant) {
            const std::uint32_t voxel = below[std::size_t(octant)];
            const bool isThere = voxel != noVoxel;
            const double own = isThere ? hierarchy_.voxels[voxel].points : 0;
            const double share =
                isThere ? double(hierarchy_.voxels[voxel].below) / double(points) : shareOfEmptyOctant;
            add(key.child(octant), voxel, at, own + above * share);
        }
    }

    void add(const VoxelKey& key, std::uint32_t voxel, std::uint32_t parent, double samples) {
        AdditiveNode own{key, voxel, {}};
        StoredNode stored;
        Node& node = stored.node;
        place(key, own.lattice, node);
        node.parent = parent;
        node.level = std::uint8_t(key.level);
        node.sampleCount =
            std::uint32_t(std::clamp(std::ceil(samples), 1.0, double(std::numeric_limits<int>::max())));
        node.points =
            std::max<std::uint64_t>(node.sampleCount, voxel == noVoxel ? 0 : hierarchy_.voxels[voxel].below);
        space(key, voxel, node);
        tree_.nodes.push_back(stored);
        tree_.own.push_back(own);
    }

    /// Its voxel and a little more, as far as the file says that there are points.
    void place(const VoxelKey& key, NodeLattice& lattice, Node& node) const {
        const double side = std::ldexp(2 * frame_.cube.halfSize, -key.level);
        const glm::dvec3 corner = cornerOf(frame_.cube, key);
        for (int a = 0; a < 3; ++a) {
            const double step = frame_.grid.step[a];
            const double more = std::max(margin * side, marginSteps * step);
            double low = corner[a] - more, high = corner[a] + side + more;
            const double first = frame_.bounds[0][a] - step, last = frame_.bounds[1][a] + step;
            if (first < high && last > low) low = std::max(low, first), high = std::min(high, last);
            const auto at = std::size_t(a);
            lattice.low[at] = std::int64_t(std::floor((low - frame_.grid.origin[a]) / step));
            const auto end = std::int64_t(std::ceil((high - frame_.grid.origin[a]) / step));
            const std::int64_t range = std::max<std::int64_t>(1, end - lattice.low[at]);
            while ((range >> lattice.shift[at]) + 1 > mostInSample) ++lattice.shift[at];
            node.step[a] = std::ldexp(step, lattice.shift[at]);
            node.boxMin[a] = frame_.grid.origin[a] + step * double(lattice.low[at]) - frame_.origin[a];
            node.boxMax[a] = node.boxMin[a] + step * double(range);
        }
        node.center = 0.5 * (node.boxMin + node.boxMax);
        node.radius = 0.5 * glm::length(node.boxMax - node.boxMin);
    }

    /// As the root's, halved from level to level; of what is not refined any more, by how many points it has.
    void space(const VoxelKey& key, std::uint32_t voxel, Node& node) const {
        const auto least = double(std::numeric_limits<float>::min());
        double mean = std::ldexp(frame_.spacing.mean, -key.level);
        double closing = std::ldexp(frame_.spacing.closing, -key.level);
        if (node.parent != noNode) {
            const Node& parent = tree_.nodes[node.parent].node;
            const bool isLast =
                voxel == noVoxel || hierarchy_.voxels[voxel].below == hierarchy_.voxels[voxel].points;
            if (voxel == noVoxel) {
                mean = parent.meanSpacing, closing = parent.spacing;
            } else if (isLast) {
                const double side = std::ldexp(2 * frame_.cube.halfSize, -key.level);
                const double ratio = std::clamp(frame_.spacing.closing / frame_.spacing.mean, 1.0, 2.0);
                mean = side / std::sqrt(double(node.sampleCount));
                closing = mean * ratio;
            }
            mean = std::min(mean, double(parent.meanSpacing));
            closing = std::min(closing, double(parent.spacing));
        }
        node.spacing = float(std::max(closing, least));
        node.meanSpacing = std::min(float(std::max(mean, least)), node.spacing);
        node.radiusUnit = node.spacing;
    }

    const VoxelTree& hierarchy_;
    const AdditiveFrame& frame_;
    AdditiveTree tree_;
};

}  // namespace

Octants::Octants(const AdditiveFrame& frame, const VoxelKey& key) {
    const double half = std::ldexp(frame.cube.halfSize, -key.level);
    middle_ = (cornerOf(frame.cube, key) + half - frame.grid.origin) / frame.grid.step;
}

Expected<AdditiveTree> additiveTree(const VoxelTree& hierarchy, const AdditiveFrame& frame) {
    return Planting(hierarchy, frame).run();
}

}  // namespace scancast
