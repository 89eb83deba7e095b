#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "renderer/cloud/build_node.hpp"

namespace scancast {

namespace {

/// A node never claims to be coarser than its parent: what is drawn below a node stays within the bounds that
/// its own spacing grew. A node that knows no spacing (all its points at one place) takes its parent's.
float settleSpacing(double own, const Node* parent, float Node::*spacing, const Grid& grid) {
    const float largest = parent ? parent->*spacing : std::numeric_limits<float>::max();
    if (own > 0) return std::clamp(float(own), std::numeric_limits<float>::min(), largest);
    if (parent) return largest;
    double step = 0;
    for (int a = 0; a < 3; ++a)
        step = std::max(step, grid.step[a] * double(std::uint64_t(1) << grid.ownShift[a]));
    return std::max(float(step), std::numeric_limits<float>::min());
}

Node toNode(const BuildNode& from, const Node* parent, const Grid& grid) {
    Node node{};
    const NodeContent& c = from.content;
    node.boxMin = c.corner;
    node.step = c.step;
    node.boxMax = c.bounds.high;
    node.center = c.bounds.center;
    node.radius = c.bounds.radius;
    node.spacing = settleSpacing(c.spacing, parent, &Node::spacing, grid);
    node.meanSpacing = std::min(node.spacing, settleSpacing(c.meanSpacing, parent, &Node::meanSpacing, grid));
    node.radiusUnit = std::max(float(c.spacing), std::numeric_limits<float>::min());
    node.childCount = std::uint8_t(from.children.size());
    node.level = std::uint8_t(from.level);
    node.sampleCount = std::uint32_t(c.samples.size());
    node.points = from.points.size();
    return node;
}

}  // namespace

Octree flatten(BuildNode& root, const Grid& grid) {
    std::vector<BuildNode*> order{&root};
    std::vector<Node> nodes{toNode(root, nullptr, grid)};
    std::uint64_t samples = nodes[0].sampleCount;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        if (!order[i]->children.empty()) nodes[i].firstChild = std::uint32_t(nodes.size());
        for (const auto& child : order[i]->children) {
            Node node = toNode(*child, &nodes[i], grid);
            node.parent = i;
            node.firstSample = samples;
            samples += node.sampleCount;
            nodes.push_back(node);
            order.push_back(child.get());
        }
    }
    std::vector<Sample> store(samples);
    tbb::parallel_for(std::size_t(0), order.size(), [&](std::size_t i) {
        auto& own = order[i]->content.samples;
        std::copy(own.begin(), own.end(), store.begin() + std::ptrdiff_t(nodes[i].firstSample));
        own = {};
    });
    return Octree(std::move(nodes), std::move(store));
}

}  // namespace scancast
