// From a scan to a cloud in memory; ingest.hpp makes a cloud file instead. Called on any thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/build/octree_shape.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/progress.hpp"

namespace scancast {

struct BuildOptions {
    std::string title;
    int threads = 0;  ///< 0 = all cores; the result does not depend on it
    OctreeShape shape{};
    std::vector<Mirror> mirrors{};
};

/// Reads a scan to its end and builds its octree in memory, in parallel. Takes ownership of nothing; `source`
/// is exhausted afterwards. Errors: the source's own; Empty when no point is left; ResourceLimit when memory
/// runs out.
Expected<std::shared_ptr<const Cloud>> buildCloud(PointSource& source, const BuildOptions& options,
                                                  const ProgressSink& progress = {});

}  // namespace scancast
