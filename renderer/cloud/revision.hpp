// A cloud's revision: a digest of everything that its pictures depend on, for ETags.
#pragma once

#include <string>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// 32 hex digits (XXH3, 128 bits) over origin, bounds, attributes and ranges, spacing, mirrors, nodes and
/// samples. The title and the name of the format are not part of it.
std::string revisionOf(const Cloud& cloud);

}  // namespace scancast
