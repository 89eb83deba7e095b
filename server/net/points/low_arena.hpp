// The cores for answers that take long, exports and rasters: whoever is drawn for goes first. A thread of its own gives it work.
#pragma once

#include <tbb/task_arena.h>

#include "server/base/faults.hpp"

namespace scancast {

struct LowArena {
    tbb::task_arena cores{tbb::task_arena::automatic, 1, tbb::task_arena::priority::low};

    /// `what`: for the log, where an exception ends it ("Making a raster").
    template <class Work>
    auto run(const char* what, Work work) {
        return contained(what, [&] { return cores.execute(work); });
    }
};

}  // namespace scancast
