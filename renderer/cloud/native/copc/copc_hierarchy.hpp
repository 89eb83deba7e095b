// The voxels of a COPC file that have points, read page by page and held against the file: each once, each with its parents, each
// chunk within the file. All pages are read: 32 bytes a voxel, of some tens of thousands of points each. Any thread; waits for
// the reader. Pipeline: layout → **hierarchy** → voxel tree.
#pragma once

#include "files/random_reader.hpp"
#include "renderer/cloud/native/copc/copc_layout.hpp"

namespace scancast {

/// Errors without the file's name: Malformed, Truncated, Empty (no voxel has points); ResourceLimit, with the way out; the reader's.
Expected<VoxelTree> readCopcHierarchy(const RandomReader& reader, const CopcInfo& info,
                                      const VoxelLimits& limits = {});

}  // namespace scancast
