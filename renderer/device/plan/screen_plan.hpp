// From lighting passes to their numbers. Pure functions; any thread. Pipeline: pass plan → **numbers** → a
// device's screen passes.
#pragma once

#include "renderer/device/plan/screen_numbers.hpp"
#include "renderer/device/plan/stages.hpp"

namespace scancast {

/// For planes whose first pixel is (x, y) of the picture, guard band included.
PhongNumbers phongNumbers(const PhongPass& pass, const Sight& sight, const glm::dvec2& jitter, int x, int y);

/// The eight neighbours at the pass's radius, and shade = exp(-300 · strength · mean response) of
/// docs/spec/shading.md §3.
EyeDomeNumbers eyeDomeNumbers(const EyeDomePass& pass);

}  // namespace scancast
