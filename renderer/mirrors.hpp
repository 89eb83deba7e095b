// The mirrors of a cloud, as a viewpoint sees them: which are in view, where in the picture, from where they
// are seen into, and what a scanner recorded behind them. docs/spec/mirrors.md §3. Pipeline: cloud +
// viewpoint → **reflections** → select, device. Pure functions; any thread.
#pragma once

#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// Where scanners record what they see in a mirror: behind its rectangle, in a pyramid that opens by 45° to
/// every side. A scanner that looked in more slantingly recorded points outside; a wider one would take more
/// of what really stands behind. Cloud-relative.
std::vector<Region> behindMirrors(const Cloud& cloud);

/// The mirrors whose reflecting side is turned to the eye and of which something lies in the view volume, in
/// the cloud's order, without their cuts. `filter` is the picture's own; `marginPx` is how far beyond its
/// border screen passes look.
std::vector<Reflection> reflectionsIn(const Cloud& cloud, const Viewpoint& viewpoint,
                                      const SampleFilter& filter, int marginPx = 0);

/// The viewpoint's mirror image: what it sees is what the viewpoint sees in the mirror, pixel for pixel.
Viewpoint reflected(const Viewpoint& viewpoint, const Mirror& mirror, const glm::dvec3& cloudOrigin);

/// What to select for a reflection, from what is selected for its picture.
SelectOptions selectionOf(const Reflection& reflection, SelectOptions pictures);

/// Shares of a budget: for the picture and for each of its mirrors, as the screen is.
std::vector<std::uint64_t> shareBudget(std::uint64_t budget, const Viewpoint& viewpoint,
                                       const std::vector<Reflection>& reflections);

}  // namespace scancast
