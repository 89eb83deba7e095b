// From a scan to a cloud: the way that buildCloud() and ingest() share. Reads like the pipeline: stage →
// choose the grid → divide into chunks → build the octree → tell its facts.
#pragma once

#include <stop_token>

#include "renderer/cloud/build/octree_builder.hpp"
#include "renderer/cloud/build/octree_shape.hpp"
#include "renderer/cloud/file/cloud_file_writer.hpp"

namespace scancast {

struct BuildRoom {
    Workspace& workspace;
    BlockSink* file = nullptr;  ///< where samples go; null = they stay in memory
    int threads = 0;            ///< 0 = all cores
    int lanes = 1;              ///< chunks in memory at once
};

struct BuiltCloud {
    CloudFacts facts;
    BuiltOctree octree;
};

/// Errors: the source's, the workspace's and the file's; Empty; Cancelled.
Expected<BuiltCloud> buildFrom(PointSource& source, const OctreeShape& shape, const BuildRoom& room,
                               const ProgressSink& progress, const std::stop_token& stop);

}  // namespace scancast
