#include "renderer/cloud/octree_builder.hpp"

#include <tbb/task_group.h>

#include <algorithm>

#include "renderer/cloud/build_node.hpp"
#include "renderer/cloud/splitter.hpp"

namespace scancast {

void grow(BuildNode& node, const OctreeInput& input, ProgressMeter& progress) {
    const Measure measured = measure(node.points);
    node.box = measured.box;
    const std::uint32_t leafPoints = std::clamp(input.leafPoints, 1u, mostLeafPoints);
    if (node.points.size() <= leafPoints || node.box.isPoint())
        if (auto leaf = makeLeaf(node.points, node.box, input.grid, input.origin)) {
            node.content = std::move(*leaf);
            progress.add(node.points.size());
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
        group.run([&child, &input, &progress] { grow(child, input, progress); });
    }
    group.wait();
}

Octree buildOctree(const OctreeInput& input, const ProgressSink& progress) {
    BuildNode root;
    root.points = input.points;
    ProgressMeter sorting(progress, "sorting", input.points.size());
    grow(root, input, sorting);
    sorting.finish();
    ProgressMeter averaging(progress, "averaging", input.points.size());
    fillInner(root, input, averaging);
    averaging.finish();
    return flatten(root, input.grid);
}

}  // namespace scancast
