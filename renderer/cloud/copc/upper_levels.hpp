// What a native cloud knows of its scan as a whole: the points of its upper levels, built into a small cloud in memory as ingest would
// build the whole. Which attributes tell points apart, where most values lie and how dense the root is come from there, by the same
// code. Pure functions; build on all cores. Pipeline: upper chunks → **small cloud** → facts, look.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/copc/additive_tree.hpp"
#include "renderer/cloud/import/las/las_reader.hpp"

namespace scancast {

/// Voxels from the root down, whole levels, until they have `enough` points or the next level has too many. Of one voxel as many points as it has, otherwise
/// not many more than 200,000.
std::vector<std::uint32_t> upperVoxels(const CopcHierarchy& hierarchy, std::uint64_t enough);

/// `records`: of each voxel's chunk. `las` has to have seen all of them. Errors: as of buildCloud().
Expected<std::shared_ptr<const Cloud>> upperCloud(LasReader las, std::vector<std::vector<std::byte>> records,
                                                  const std::string& title, bool surfels);

/// Of the root's own records; of a root without points, by its cube.
RootSpacing rootSpacing(std::span<const std::byte> records, const LasReader& las, const CopcInfo& info);

}  // namespace scancast
