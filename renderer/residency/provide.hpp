// From the nodes that selection wants to the samples that are drawn: what is in memory, ancestors for what is
// not, and asks for the rest. Pipeline: select → **provide** → device.
//
// *Thread safety*: may be called from any thread.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "renderer/select/select.hpp"

namespace scancast {

struct ProvideOptions {
    /// Loads what is missing, several blocks at a time, and returns exactly what is wanted (but for damaged
    /// blocks). Else what is in memory is drawn, and the rest requested.
    bool wait = true;
    /// On whose behalf blocks are requested: the newest call's requests take the place of the earlier ones'.
    std::uint64_t requester = 0;
    /// Runs that the next pictures may want, requested behind everything that is missing now. Without wait
    /// only.
    std::span<const CutRun> ahead{};
    /// Runs of the same picture's other cuts, as urgent as this one's. Without wait only.
    std::span<const CutRun> beside{};
    /// Whether to request anything: of a picture's cuts, one speaks for all. Without wait only.
    bool request = true;
};

/// Every leaf below a wanted node is covered by one whole run, as in any cut: whole runs without samples are
/// replaced by the nearest ancestor that has some, whole, which also takes the place of everything else below
/// it; parts of runs, which another covers, are left out. So is a node none of whose ancestors has samples.
/// The cut keeps its samples in memory as long as it lives. Errors: Cancelled; with wait, Unavailable where blocks
/// cannot be had at present, and later can.
Expected<Cut> provide(const Octree& octree, Cut wanted, const ProvideOptions& options = {},
                      std::stop_token stop = {});

}  // namespace scancast
