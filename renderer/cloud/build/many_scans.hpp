// Several scans as one, one after the other. Pipeline: import → **many scans** → staging. Owned and used by
// one thread.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// At least one source. Attributes are those that any of them has; columns those of the first (what another
/// lacks is 0). `names` are what messages call them, in their order; without, they are numbered. InvalidArgument when their
/// coordinate reference systems forbid it (merged_crs.hpp); at the end of reading, too, where only then it is known where they lie.
Expected<std::unique_ptr<PointSource>> manyScans(std::vector<std::unique_ptr<PointSource>> sources,
                                                 std::span<const std::string> names = {});

}  // namespace scancast
