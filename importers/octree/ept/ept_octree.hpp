// An EPT folder as an octree whose tiles are its pieces. Pipeline: description, hierarchy → **tiles** → point stream.
#pragma once

#include <memory>

#include "importers/octree/tree/octree.hpp"

namespace scancast::import_octree {

/// Reads ept.json and the whole hierarchy, and looks whether every tile is there and can hold its points. `files` outlives
/// it. Errors: Malformed, Unsupported, Empty, NotFound, Truncated, ResourceLimit, Io; they name the file.
Expected<std::unique_ptr<Octree>> openEpt(const TreeFiles& files, bool keepAttributes);

}  // namespace scancast::import_octree
