// A cloud file as a cloud to look at: facts and nodes at once, samples as they are wanted. Place: cloud file
// →
// **open** → catalog.
#pragma once

#include <filesystem>
#include <memory>

#include "renderer/cloud/cloud.hpp"
#include "renderer/residency/block_cache.hpp"

namespace scancast {

/// Takes milliseconds: reads the file's index and the root's block; the levels below it follow in the
/// background. Errors: those of CloudFile::open();
/// ResourceLimit for a file with a block that is too large for the memory limit. A damaged root is none: the rest can be looked at.
Expected<std::shared_ptr<const Cloud>> openCloud(InputFile file, const std::shared_ptr<BlockCache>& cache);
Expected<std::shared_ptr<const Cloud>> openCloud(const std::filesystem::path& path,
                                                 const std::shared_ptr<BlockCache>& cache);
Expected<std::shared_ptr<const Cloud>> openCloud(std::shared_ptr<const CloudFile> file,
                                                 const std::shared_ptr<BlockCache>& cache);

/// Whether the file at this path starts as cloud files do. Files that cannot be read do not.
bool isCloudFileAt(const std::filesystem::path& path);

}  // namespace scancast
