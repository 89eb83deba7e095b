// The nodes of an EPT folder and how many points each has: all pages of its hierarchy, one after the other.
// Pipeline: description → **hierarchy** → tiles → points.
#pragma once

#include <deque>

#include "importers/octree/tree/tree_files.hpp"
#include "renderer/cloud/import/octree/ept_page.hpp"

namespace scancast::import_octree {

/// All nodes that have points, level after level. Errors: those of reading a page, Malformed, ResourceLimit; they name it.
Expected<std::deque<EptNode>> readEptHierarchy(const TreeFiles& files);

}  // namespace scancast::import_octree
