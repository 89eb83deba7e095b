// From a run of the cut to its numbers: node → view → picture composed in double, so that no large coordinate
// reaches a float sum; clip box and dropped regions in the integers of its samples. Pure functions; any
// thread. Pipeline: cut → **runs** → device.
#pragma once

#include <optional>
#include <vector>

#include "renderer/device/plan/stages.hpp"

namespace scancast {

/// nullopt: nothing of the run can be drawn.
std::optional<RunNumbers> runNumbers(const CutRun& run, const Sight& sight, const ColorRule& color,
                                     const SampleFilter& filter);

/// The dropped regions that cross the node; nullopt: one holds all of it.
std::optional<std::vector<DroppedRegion>> droppedRegions(const Node& node, const SampleFilter& filter);

/// p = clamp(factor · ratio (/ d in perspective), minPx, maxPx) of the run's sprites.
double spriteFactor(const RunNumbers& run, const SplatStage& stage, const Viewpoint& viewpoint);

}  // namespace scancast
