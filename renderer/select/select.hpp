// Selection: cloud + viewpoint → cut, the runs of samples to draw. A pure function with counters.
// Pipeline: octree → **select** → device. Source: 001_c3e54385a9f0e90c, Algorithm 3; methods.md §6.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "renderer/cloud/octree.hpp"
#include "renderer/select/viewpoint.hpp"

namespace scancast {

struct SelectOptions {
    double detail = 1;                     ///< τ in px: refine while the projected spacing exceeds it; 0 = to the leaves
    std::optional<std::uint64_t> budget;   ///< samples at most; the coarsest possible cut is drawn even if above it
    /// Bounds are grown by this many px and by `growSpacings` × the node's spacing before frustum culling: half of
    /// the largest splat that the method draws, so that culled = not culled, pixel for pixel.
    double growPx = 1;
    double growSpacings = 0;
    bool cull = true;
    bool bruteForce = false;               ///< every leaf sample; no selection, no culling
};

struct CutRun {
    const Node* node = nullptr;
    std::uint32_t nodeIndex = noNode;
    std::span<const Sample> samples;
    std::uint32_t firstOrdinal = 0;        ///< ordinal in the cut of samples[0]; ordinals are dense
};

/// Runs ordered by node index, so ordinals depend on the view alone, not on threads or time. Points into the octree.
struct Cut {
    std::vector<CutRun> runs;
    std::uint64_t samples = 0;
    std::uint64_t points = 0;              ///< scan points that the drawn nodes stand for
    std::uint32_t nodesVisited = 0, nodesCulled = 0, nodesRefined = 0;
    double spacingReached = 0;             ///< largest projected spacing drawn, px
    bool budgetReached = false;
};

Cut select(const Octree& octree, const Viewpoint& viewpoint, const SelectOptions& options);

}  // namespace scancast
