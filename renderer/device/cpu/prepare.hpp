// From a cut to kernel input: each run's numbers (renderer/device/host), and what is known of a run before
// its samples are touched - where it lies on the picture, how near, how large its splats get. Pure functions;
// any thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "renderer/device/cpu/kernels/kernels.hpp"
#include "renderer/device/host/splats.hpp"

namespace scancast::cpu {

/// Half-open, pixels of the whole picture.
struct Rect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool empty() const { return x1 <= x0 || y1 <= y0; }
    Rect intersect(const Rect& o) const {
        return {x0 > o.x0 ? x0 : o.x0, y0 > o.y0 ? y0 : o.y0, x1 < o.x1 ? x1 : o.x1, y1 < o.y1 ? y1 : o.y1};
    }
};

/// How large a run's splats are in one pass.
struct PassSize {
    float sizeFactor = 0, largestPx = 0;
    /// Bits of a depth: where something lies in front of it, the pass draws nothing of the run. 0: unknown.
    std::int32_t frontOrder = 0;
};

struct PreparedRun {
    SplatRun run;
    std::shared_ptr<const std::vector<RunRegion>> regions;  ///< what `run` points to
    Rect bounds;  ///< no fragment of any jittered frame lies outside; clipped to the area drawn
    std::array<PassSize, mostSplatPasses> sizes;  ///< by pass
    float front = 0;                              ///< no fragment lies in front of this depth
    double work = 0;                              ///< estimated cost, cycles
};

/// nullopt: nothing of the run can be seen in `area`. `maxJitter` is the largest shift of any frame, px.
std::optional<PreparedRun> prepareRun(const CutRun& run, const LayerView& layerView,
                                      std::span<const SplatPass> passes, const ColorRule& color,
                                      const SampleFilter& filter, const Rect& area, double maxJitter);

}  // namespace scancast::cpu
