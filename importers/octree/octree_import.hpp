// An octree that is kept as a folder - EPT or Potree - to the point stream: description, hierarchy, how its colours are
// meant, then all points of all nodes, decoded by several threads and sent in order. Pipeline: folder → **octree** → stream.
#pragma once

#include <array>
#include <memory>

#include "importers/octree/tree/octree.hpp"
#include "importers/octree/tree/piece_runner.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::import_octree {

/// The files that describe one, in the order in which a folder is looked through.
inline constexpr std::array<const char*, 3> descriptions{"ept.json", "metadata.json", "cloud.js"};

/// All that is known of an octree before a point is decoded. `description`: which of the files it is. `files` outlives it.
/// Errors: without the folder's name; Malformed, Unsupported, Empty, NotFound, Truncated, ResourceLimit, Io.
Expected<std::unique_ptr<Octree>> openOctree(const TreeFiles& files, const std::string& description,
                                             bool keepAttributes);

/// Sends it all, its end included. Errors as above, and Io when nobody reads any more.
Expected<void> writeOctree(const Octree& octree, PointStreamWriter& writer,
                           unsigned threads = decodingThreads());

/// `path`: the folder, or the description in it.
Expected<void> importOctree(const std::filesystem::path& path, bool keepAttributes,
                            PointStreamWriter& writer);

}  // namespace scancast::import_octree
