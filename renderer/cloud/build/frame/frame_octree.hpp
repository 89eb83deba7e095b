// The octree of a frame: points in Morton order are leaves as they stand, cells of them are what inner nodes hold.
// Pure function; uses the caller's TBB arena; the same on any number of threads. Pipeline: order, surface → **octree**
// → cloud of a frame.
#pragma once

#include "renderer/cloud/build/frame/frame_surface.hpp"
#include "renderer/cloud/build/octree_builder.hpp"

namespace scancast {

struct FrameOctreeInput {
    const FrameOrder& order;
    const FrameSurface& surface;
    bool surfels = true;    ///< samples carry radius and normal
    bool oriented = false;  ///< normals point to the side that was scanned
};

/// Nodes, samples and their hashes; `sure` is not filled in.
BuiltOctree buildFrameOctree(const FrameOctreeInput& input);

}  // namespace scancast
