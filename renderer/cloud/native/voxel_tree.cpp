#include "renderer/cloud/native/voxel_tree.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

namespace scancast {

namespace {

std::uint64_t digestOf(const VoxelTree& all) {
    std::uint64_t digest = 0;
    for (const Voxel& voxel : all.voxels) {
        const std::array<std::uint64_t, 4> words{
            std::uint64_t(voxel.key.level) << 32 | std::uint32_t(voxel.key.at[0]),
            std::uint64_t(voxel.key.at[1]) << 32 | std::uint32_t(voxel.key.at[2]), voxel.offset,
            std::uint64_t(voxel.bytes) << 32 | voxel.points};
        digest = XXH3_64bits_withSeed(words.data(), sizeof words, digest);
    }
    return digest;
}

}  // namespace

std::string text(const VoxelKey& key) {
    return fmt::format("{}-{}-{}-{}", key.level, key.at[0], key.at[1], key.at[2]);
}

std::uint32_t VoxelTree::find(const VoxelKey& key) const {
    const auto at = std::ranges::lower_bound(voxels, key, {}, &Voxel::key);
    return at != voxels.end() && at->key == key ? std::uint32_t(at - voxels.begin()) : noVoxel;
}

Expected<VoxelTree> voxelTreeOf(std::vector<Voxel> voxels) {
    std::ranges::sort(voxels, {}, &Voxel::key);
    VoxelTree all;
    all.voxels = std::move(voxels);
    for (std::size_t i = 1; i < all.voxels.size(); ++i)
        if (all.voxels[i].key == all.voxels[i - 1].key)
            return fail(ErrorCode::Malformed,
                        fmt::format("voxel {} is in its octree twice", text(all.voxels[i].key)));
    // From the deepest up: each is counted before its parent is.
    for (std::size_t i = all.voxels.size(); i-- > 0;) {
        const Voxel& voxel = all.voxels[i];
        if (voxel.below == 0 || voxel.key.level == 0) continue;
        const std::uint32_t parent = all.find(voxel.key.parent());
        if (parent == noVoxel)
            return fail(ErrorCode::Malformed, fmt::format("voxel {} of its octree has no parent{}",
                                                          text(voxel.key), ingestInstead));
        all.voxels[parent].below += voxel.below;
    }
    std::erase_if(all.voxels, [](const Voxel& voxel) { return voxel.below == 0; });
    if (all.voxels.empty()) return fail(ErrorCode::Empty, "it has no points");
    all.points = all.voxels.front().below;
    all.digest = digestOf(all);
    return all;
}

}  // namespace scancast
