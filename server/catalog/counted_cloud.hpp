// A cloud in memory that counts against the memory limit. Pure function. Place: builders → **counted** → catalog.
#pragma once

#include <memory>

#include "renderer/cloud/cloud.hpp"
#include "renderer/residency/block_cache.hpp"

namespace scancast {

/// Counts what it takes, as long as anybody looks at it.
std::shared_ptr<const Cloud> counted(std::shared_ptr<const Cloud> cloud,
                                     const std::shared_ptr<BlockCache>& cache);

}  // namespace scancast
