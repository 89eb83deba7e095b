// A camera that walks around a point. Pure functions; any thread.
#pragma once

#include "protocol/view/view.hpp"

namespace scancast::client {

/// The camera turned by `degrees` around the line through `center` along `axis` (of any length but 0),
/// counter-clockwise for whom the axis points at, and looking at the centre. Distance and height stay; up
/// turns along, so that a view from straight above spins. The camera must not have a viewMatrix.
Camera orbitedCamera(const Camera& camera, const glm::dvec3& center, const glm::dvec3& axis, double degrees);

}  // namespace scancast::client
