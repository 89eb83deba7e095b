#include "importers/octree/ept/ept_hierarchy.hpp"

#include <algorithm>

namespace scancast::import_octree {

namespace {

constexpr std::uint64_t longestPage = std::uint64_t(64) << 20;

}  // namespace

Expected<std::deque<EptNode>> readEptHierarchy(const TreeFiles& files) {
    EptPages pages;
    pages.ahead.push_back({});
    for (; !pages.ahead.empty(); pages.ahead.pop_front()) {
        const VoxelKey root = pages.ahead.front();
        const auto bytes = files.readAll(eptPageName(root), longestPage);
        if (!bytes) return passOn(bytes);
        if (auto ok = parseEptPage(*bytes, root, pages); !ok) return passOn(ok);
    }
    auto& nodes = pages.nodes;
    std::sort(nodes.begin(), nodes.end(), [](const EptNode& a, const EptNode& b) { return a.key < b.key; });
    const auto twice = std::adjacent_find(nodes.begin(), nodes.end(),
                                          [](const EptNode& a, const EptNode& b) { return a.key == b.key; });
    if (twice != nodes.end())
        return fail(ErrorCode::Malformed, "its hierarchy has the node " + text(twice->key) + " twice");
    std::erase_if(nodes, [](const EptNode& node) { return node.points == 0; });
    return std::move(nodes);
}

}  // namespace scancast::import_octree
