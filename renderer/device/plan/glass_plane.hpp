// Where a mirror's glass is seen on the picture. A pure function; any thread. Pipeline: reflection →
// **glass** → a device's mirrors.
#pragma once

#include "renderer/device/plan/screen_numbers.hpp"
#include "renderer/device/plan/stages.hpp"

namespace scancast {

/// In one jittered frame of the picture; `sight` is the picture's, or that of the reflected eye.
GlassNumbers glassNumbers(const MirrorGlass& glass, const Sight& sight, const glm::dvec2& jitter);

}  // namespace scancast
