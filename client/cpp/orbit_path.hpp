// A camera that walks around a point. Pure functions; any thread.
#pragma once

#include "protocol/view.hpp"

namespace scancast::client {

/// The camera turned by `degrees` around the vertical axis (Z) through `center`, counter-clockwise as seen
/// from above, and looking at it. Distance and height stay; up turns along, so that a view from straight
/// above spins. The camera must not have a viewMatrix.
Camera orbitedCamera(const Camera& camera, const glm::dvec3& center, double degrees);

}  // namespace scancast::client
