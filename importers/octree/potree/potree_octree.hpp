// A Potree octree, 1.0-1.8 or 2.x, whose nodes are its pieces. Pipeline: description, nodes → **pieces** → point stream.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>

#include "importers/octree/tree/octree.hpp"

namespace scancast::import_octree {

/// Reads cloud.js and the hierarchy, and looks at every node's file. `files` outlives it. Errors: Malformed, Unsupported,
/// Empty, NotFound, Truncated, ResourceLimit, Io; they name the file.
Expected<std::unique_ptr<Octree>> openPotree1(const TreeFiles& files, bool keepAttributes);

/// The same of metadata.json, hierarchy.bin and octree.bin.
Expected<std::unique_ptr<Octree>> openPotree2(const TreeFiles& files, bool keepAttributes);

/// "the number of points", where a JSON file says it; what is no number says nothing.
std::optional<std::uint64_t> declaredPoints(const nlohmann::json& json);

}  // namespace scancast::import_octree
