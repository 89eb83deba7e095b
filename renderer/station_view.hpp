// From where a scanner stood, or a photo was taken: the picture that somebody expects who jumps there. Pure functions.
// Pipeline: facts → **a station's view, a photo's** → API, page.
#pragma once

#include <optional>

#include "protocol/view/view.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Eye at the scanner, horizon level, a little downwards: forwards as the scanner faced, or, where that is not known or is
/// up or down, towards the middle of the cloud. File coordinates.
Camera stationCamera(const Cloud& cloud, const Station& station);

/// Eye where the photo was taken; nullopt where nobody knows that. Of a flat one what it shows, upright as it is, all of it in a
/// picture of this `aspect` (width / height), 75° where its angles are not known; of all others as from a station whose scanner
/// faced the photo's middle. File coordinates.
std::optional<Camera> photoCamera(const Cloud& cloud, const Photo& photo, double aspect);

}  // namespace scancast
