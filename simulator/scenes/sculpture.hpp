// The figure of the statue scene: a draped woman with a book, 1.9 m high, made of smoothly joined bodies, as
// a signed distance and as a mesh with the light that its own folds leave. Local frame: feet on z = 0 around
// the origin, facing south (-y).
#pragma once

#include "simulator/surface_net.hpp"

namespace scancast {

/// Metres, negative inside; not a true distance between the folds, but never twice too large.
float sculptureDistance(const glm::vec3& at);

struct Sculpture {
    SurfaceMesh mesh;
    std::vector<float> openness;  ///< of each vertex: how much of the sky its surroundings leave free
    std::vector<float> sunlit;    ///< of each vertex: how much of the sun
};

/// Carved on the first call and kept: a second or so.
const Sculpture& sculpture();

/// Where the statue scene's sun stands.
inline const glm::vec3 statueSun{-0.5029F, -0.6286F, 0.5932F};

}  // namespace scancast
