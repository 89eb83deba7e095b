// Several scans as one, one after the other. Pipeline: import → **many scans** → staging. Owned and used by
// one thread.
#pragma once

#include <memory>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// At least one source. Attributes are those that any of them has; columns those of the first (what another
/// lacks is 0). InvalidArgument when two name different coordinate reference systems.
Expected<std::unique_ptr<PointSource>> manyScans(std::vector<std::unique_ptr<PointSource>> sources);

}  // namespace scancast
