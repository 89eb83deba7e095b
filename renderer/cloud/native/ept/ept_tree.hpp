// The voxels of an EPT set that have points: all pages of its hierarchy, those of one depth asked for together, each read once. Any thread;
// waits for the files. Pipeline: description → **hierarchy** → voxel tree.
#pragma once

#include "files/folder_reader.hpp"
#include "renderer/cloud/native/voxel_tree.hpp"

namespace scancast {

/// Of a page of the hierarchy: bytes.
inline constexpr std::uint64_t longestEptPage = 16 << 20;

/// Errors without the set's name: Malformed, Empty, NotFound; ResourceLimit, with the way out; those of the files.
Expected<VoxelTree> readEptTree(const FolderReader& files, const VoxelLimits& limits = {});

}  // namespace scancast
