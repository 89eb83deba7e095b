// What hands do to a camera: pure functions, in px of a picture `height` px high. Any thread.
//
// The camera must not have a viewMatrix. Whatever is done, eye and target stay apart and up stays off the
// view direction, so that there is always a picture.
#pragma once

#include "protocol/view/view.hpp"

namespace scancast::client {

/// Turns the eye around the target, as if the scene were held: a drag over the height of the picture is half
/// a turn. It stops 1° short of straight up and down. `up` is the cloud's upward direction.
Camera orbited(const Camera& camera, const glm::dvec3& up, double dx, double dy, int height);
/// Moves eye and target sideways, so that what lies at the target stays under the pointer.
Camera panned(const Camera& camera, double dx, double dy, int height);
/// Comes nearer by a factor (2 = half the distance, half the height of an orthographic picture).
Camera zoomed(const Camera& camera, double factor);
/// Moves eye and target along the view direction, to the right and up, in distances of eye and target.
Camera flown(const Camera& camera, double forward, double right, double up);

}  // namespace scancast::client
