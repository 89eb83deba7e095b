// The mirrors of a cloud, as a viewpoint sees them: which are in view, where in the picture, from where they
// are seen into, and what a scanner recorded behind them. docs/spec/mirrors.md §3. Pipeline: cloud +
// viewpoint → **reflections** → select, device. Pure functions; any thread.
#pragma once

#include <span>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// Where scanners record what they see in a mirror: behind its rectangle, in a pyramid that opens by 45° to
/// every side. A scanner that looked in more slantingly recorded points outside; a wider one would take more
/// of what really stands behind. Cloud-relative.
std::vector<Region> behindMirrors(const Cloud& cloud);

/// The mirrors whose reflecting side is turned to the eye and of which something lies in the view volume, in
/// the cloud's order: what is to be drawn of them, with cuts that are still empty. `filter` is the main
/// view's; `marginPx` is how far beyond its border screen passes look.
std::vector<CutView> reflectionsIn(const Cloud& cloud, const Viewpoint& viewpoint, const SampleFilter& filter,
                                   int marginPx = 0);

/// The viewpoint's mirror image: what it sees is what the viewpoint sees in the mirror, pixel for pixel.
Viewpoint reflected(const Viewpoint& viewpoint, const Mirror& mirror, const glm::dvec3& cloudOrigin);

/// What to select for one of a picture's cuts, from what is selected for the whole: of a reflection, what is
/// seen in its mirror.
SelectOptions selectionOf(const CutView& view, SelectOptions pictures);

/// Shares of a budget for each of a picture's cuts, as the screen is theirs.
std::vector<std::uint64_t> shareBudget(std::uint64_t budget, std::span<const CutView> cuts);

}  // namespace scancast
