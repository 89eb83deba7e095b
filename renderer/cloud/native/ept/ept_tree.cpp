#include "renderer/cloud/native/ept/ept_tree.hpp"

#include <fmt/format.h>

#include <deque>
#include <utility>

#include "renderer/cloud/import/octree/ept_page.hpp"

namespace scancast {

namespace {

constexpr std::uint64_t mostPageBytes = 512 << 20;  // of all pages

Expected<Voxel> voxelOf(const import_octree::EptNode& node, const VoxelLimits& limits) {
    if (node.key.depth > std::uint32_t(deepestVoxel))
        return fail(ErrorCode::Malformed,
                    fmt::format("node {} of its hierarchy is too deep", import_octree::text(node.key)));
    if (node.points > limits.points)
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("node {} has {} points, too many to be shown as they are{}",
                                import_octree::text(node.key), node.points, ingestInstead));
    Voxel voxel;
    voxel.key = {std::int32_t(node.key.depth),
                 {std::int32_t(node.key.x), std::int32_t(node.key.y), std::int32_t(node.key.z)}};
    voxel.points = std::uint32_t(node.points);
    voxel.below = node.points;
    return voxel;
}

/// Adds the page of `root`; the bytes that were read. What came over a network may be sound the second time.
Expected<std::uint64_t> addPage(const FolderReader& files, const import_octree::VoxelKey& root,
                                import_octree::EptPages& pages) {
    const std::string name = import_octree::eptPageName(root);
    const std::size_t nodes = pages.nodes.size(), ahead = pages.ahead.size();
    std::uint64_t bytesRead = 0;
    for (int tries = 2;; --tries) {
        const auto bytes = files.read(name, longestEptPage);
        if (!bytes) return passOn(bytes);
        bytesRead += bytes->size();
        auto ok = import_octree::parseEptPage(*bytes, root, pages);
        if (ok) return bytesRead;
        if (ok.error().code != ErrorCode::Malformed || !files.forget(name) || tries == 1) return passOn(ok);
        pages.nodes.resize(nodes);
        for (; pages.ahead.size() > ahead; pages.ahead.pop_back()) pages.known.erase(pages.ahead.back());
    }
}

}  // namespace

Expected<VoxelTree> readEptTree(const FolderReader& files, const VoxelLimits& limits) {
    import_octree::EptPages pages;
    pages.ahead.emplace_back();
    std::uint64_t pagesRead = 0, bytesRead = 0;
    const auto isTooLarge = [&] {
        return pages.nodes.size() > limits.entries || pagesRead + pages.ahead.size() > limits.pages ||
               bytesRead > mostPageBytes;
    };
    while (!pages.ahead.empty()) {
        const auto now = std::exchange(pages.ahead, {});
        pagesRead += now.size();
        for (const auto& root : now) files.expect(import_octree::eptPageName(root), longestEptPage);
        for (const auto& root : now) {
            const auto bytes = addPage(files, root, pages);
            if (!bytes) return passOn(bytes);
            bytesRead += *bytes;
            if (isTooLarge())
                return fail(ErrorCode::ResourceLimit,
                            fmt::format("its hierarchy has more than {} nodes or {} pages, and is not shown "
                                        "as it is{}",
                                        limits.entries, limits.pages, ingestInstead));
        }
    }
    std::vector<Voxel> voxels;
    voxels.reserve(pages.nodes.size() + 1);
    bool hasRoot = false;
    for (const auto& node : pages.nodes) {
        auto voxel = voxelOf(node, limits);
        if (!voxel) return passOn(std::move(voxel));
        hasRoot = hasRoot || voxel->key == VoxelKey{};
        voxels.push_back(*voxel);
    }
    // One without points may be left out.
    if (!hasRoot) voxels.emplace_back();
    return voxelTreeOf(std::move(voxels));
}

}  // namespace scancast
