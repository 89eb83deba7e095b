// A scan whose rows keep what samples round and its grid does not give back: `ingest --exact`. Pipeline: import →
// many scans → **exact scan** → staging. Owned and used by one thread.
#pragma once

#include <memory>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// Whether all of them declare the same grid.
bool shareOneGrid(const std::vector<std::unique_ptr<PointSource>>& sources);

/// `source` with columns more (exact_columns.hpp): its own normals, where it has some; its positions, unless
/// `onOneGrid`, where the builder keeps them by itself.
std::unique_ptr<PointSource> exactScan(std::unique_ptr<PointSource> source, bool onOneGrid);

}  // namespace scancast
