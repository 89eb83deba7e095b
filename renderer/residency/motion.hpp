// Where a camera that moves will be: what prefetching looks at. Pure functions.
#pragma once

#include <optional>

#include "protocol/view/view.hpp"

namespace scancast {

/// The camera `ahead` seconds after `now`, when it was at `before` `elapsed` seconds earlier: position and
/// target go on as they went, turning included (a turning camera's target goes round its eye). nullopt when
/// nothing moved, when the two are too far apart in time to belong to one motion, or differ in kind.
std::optional<Camera> extrapolate(const Camera& before, const Camera& now, double elapsed, double ahead);

}  // namespace scancast
