// Where a walk around a cloud begins, from the words of the command line. A plain value; any thread.
#pragma once

#include "client/cpp/orbit_path.hpp"
#include "protocol/catalog.hpp"
#include "protocol/flags/view_flags.hpp"

namespace scancast::client {

struct OrbitStart {
    View view;          ///< the first step
    glm::dvec3 center;  ///< walked around
    glm::dvec3 axis;    ///< the cloud's own upward direction, whichever way the picture is held

    View at(double degrees) const {
        View turned = view;
        turned.camera = orbitedCamera(view.camera, center, axis, degrees);
        return turned;
    }
};

/// Around --target, else the middle of the cloud, at the distance and height of --eye. InvalidArgument for a
/// --view-matrix, and whatever the words are refused for.
Expected<OrbitStart> orbitStart(const ViewFlags& flags, const CloudInfo& cloud);

}  // namespace scancast::client
