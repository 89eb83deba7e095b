// From where a scanner stood: the picture that somebody expects who jumps there. Pure function.
// Pipeline: facts → **a station's view** → API, page.
#pragma once

#include "protocol/view/view.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Eye at the scanner, horizon level, a little downwards: forwards as the scanner faced, or, where that is not known or is
/// up or down, towards the middle of the cloud. File coordinates.
Camera stationCamera(const Cloud& cloud, const Station& station);

}  // namespace scancast
