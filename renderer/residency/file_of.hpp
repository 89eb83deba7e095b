// All that is kept of a cloud that is looked at, as a cloud file: its own; of a cloud in memory the samples and the facts.
// Place: catalog → **file of a cloud** → export, profile. Pure; any thread.
#pragma once

#include <memory>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/cloud_file.hpp"

namespace scancast {

/// Unsupported where the points are neither in a file nor in this process' memory.
Expected<std::shared_ptr<const CloudFile>> fileOf(const std::shared_ptr<const Cloud>& cloud);

}  // namespace scancast
