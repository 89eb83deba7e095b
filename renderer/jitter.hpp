// Sub-pixel shifts of the frames that are averaged into one picture. A pure function; any thread.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

namespace scancast {

/// Halton points (bases 2 and 3) around their own mean, px: anti-aliasing must not move the picture. One
/// shift of nothing for one frame.
std::vector<glm::dvec2> jitterSequence(int frames);

}  // namespace scancast
