#include "renderer/cloud/build/nodes/subtree.hpp"

#include <tbb/task_group.h>

#include <algorithm>

#include "renderer/cloud/build/chunks/splitter.hpp"

namespace scancast {

void grow(BuildNode& node, const OctreeInput& input) {
    const Measure measured = measure(node.points);
    node.box = measured.box;
    node.pointCount = node.points.size();
    const std::uint32_t leafPoints = std::clamp(input.shape.leafPoints, 1u, mostLeafPoints);
    if (node.points.size() <= leafPoints || node.box.isPoint())
        if (auto leaf = makeLeaf(node.points, node.box, input.grid, input.origin)) {
            node.content = std::move(*leaf);
            node.stored.node.sampleCount = std::uint32_t(node.content.samples.size());
            return;
        }
    const Octants octants = split(node.points, measured, input.grid, node.level);
    tbb::task_group group;
    for (int o = 0; o < 8; ++o) {
        const std::size_t first = octants.first[o], last = octants.first[o + 1];
        if (first == last) continue;
        BuildNode& child = *node.children.emplace_back(std::make_unique<BuildNode>());
        child.points = node.points.subspan(first, last - first);
        child.level = node.level + 1;
        child.parent = &node;
        group.run([&child, &input] { grow(child, input); });
    }
    group.wait();
}

void fillBelow(BuildNode& node, const OctreeInput& input) {
    if (node.isLeaf()) return;
    tbb::task_group group;
    for (auto& child : node.children) group.run([&child, &input] { fillBelow(*child, input); });
    group.wait();
    fillInner(node, input);
}

}  // namespace scancast
