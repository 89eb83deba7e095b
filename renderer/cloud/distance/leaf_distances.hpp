// How far the points of one leaf are from the earlier epoch: exact, each by the nearest point that there is. Pipeline: earlier points →
// **distances** → column. Any thread; the result depends on the points alone.
#pragma once

#include <span>

#include "protocol/error.hpp"
#include "renderer/cloud/distance/earlier_points.hpp"

namespace scancast {

/// For each of `places` (file coordinates, neighbours mostly beside each other) the distance to the nearest earlier point, or `most`
/// where that is farther away: the square root of the smallest sum of squares in double, rounded to float. `most` > 0, finite.
/// Errors: the file's.
Expected<void> leafDistances(const EarlierPoints& earlier, std::span<const glm::dvec3> places, double most,
                             std::span<float> distances);

}  // namespace scancast
