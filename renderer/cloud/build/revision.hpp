// A cloud's revision: a digest of everything that its pictures depend on, for ETags.
#pragma once

#include <string>

#include "renderer/cloud/build/octree_builder.hpp"

namespace scancast {

/// 32 hex digits (XXH3, 128 bits) over origin, bounds, attributes and ranges, spacing, mirrors, nodes and
/// samples (by their hashes). The title and the name of the format are not part of it. The same whether the
/// samples are in memory or in a file.
std::string revisionOf(const CloudFacts& facts, const BuiltOctree& octree);

}  // namespace scancast
