// What each rank has learnt of its points becomes what is known of all: ranges, sketches, the counting grid. All ranks call these, and
// have the same afterwards. Pipeline: staging → **joined** → plan; counting grid → **joined** → chunk layout.
#pragma once

#include "ranks/mpi/communicator.hpp"
#include "renderer/cloud/build/chunks/ordered_cells.hpp"
#include "renderer/cloud/build/chunks/staging.hpp"

namespace scancast {

/// `scan` keeps its own batches; all else in it becomes what it would be if it had staged everybody's points.
Expected<void> joinStaged(StagedScan& scan, const Communicator& ranks);

Expected<OrderedCells> joinCounts(CountingGrid mine, const GridBox& box, const Communicator& ranks);

/// At rank 0, `sketch` becomes that of everybody's values.
Expected<void> joinSketch(ValueSketch& sketch, const Communicator& ranks);

}  // namespace scancast
