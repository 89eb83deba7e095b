// What a native cloud knows of its scan as a whole: the points of its upper levels, built into a small cloud in memory as ingest would
// build the whole. Which attributes tell points apart, where most values lie and how dense the root is come from there, by the same
// code. Pure functions; build on all cores. Pipeline: upper chunks → **small cloud** → facts, look.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/native/raw_points.hpp"
#include "renderer/cloud/native/voxel_source.hpp"

namespace scancast {

/// Voxels from the root down, whole levels, until they have `enough` points or the next level has too many. Of one voxel as many points as it has, otherwise
/// not many more than 200,000; of 512 voxels at most.
std::vector<std::uint32_t> upperVoxels(const VoxelTree& hierarchy, std::uint64_t enough);

/// `records`: of each voxel that was read; `depth`: what their colours say together. Errors: as of buildCloud().
Expected<std::shared_ptr<const Cloud>> upperCloud(const NativeScan& scan, LasColorDepth depth,
                                                  std::vector<std::vector<std::byte>> records,
                                                  const std::string& title, bool surfels);

/// Of the root's own points; of a root without points, by its cube.
RootSpacing rootSpacing(std::span<const RawPoint> points, const NativeScan& scan);

}  // namespace scancast
