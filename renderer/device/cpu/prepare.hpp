// From a cut to kernel input: node → view → picture composed in double on the host, per run, and what is
// known of a run before its samples are touched - where it lies on the picture, how near, how large its
// splats get. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/device/cpu/colors.hpp"
#include "renderer/device/cpu/kernels/kernels.hpp"
#include "renderer/device/device.hpp"

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

struct PreparedRun {
    SplatRun run;
    Rect bounds;  ///< no fragment of any jittered frame lies outside; clipped to the area drawn
    std::int32_t nearestOrder = 0;  ///< bits of a depth that no fragment lies in front of
    double work = 0;                ///< estimated cost, cycles
};

/// `jitter` is left out: it only moves centerX and centerY.
SplatPass preparePass(const Viewpoint& viewpoint, const NearestPass& pass);

/// nullopt: nothing of the run can be seen in `area`. `maxJitter` is the largest shift of any frame, px.
std::optional<PreparedRun> prepareRun(const CutRun& run, const Viewpoint& viewpoint,
                                      const NearestPass& nearest, const SplatPass& pass,
                                      const ColorRule& color, const SampleFilter& filter, const Rect& area,
                                      double maxJitter);

}  // namespace scancast::cpu
