// Where a ray meets a patch: the inverse of Patch::at. Exact for every shape; with an offset the patch is met
// as if it had been moved along its normals, which is how the relief of materials is followed.
#pragma once

#include <optional>

#include "simulator/model.hpp"

namespace scancast {

/// origin + t · direction; the direction may have any length but 0.
struct Ray {
    glm::dvec3 origin{0}, direction{0, 0, -1};

    glm::dvec3 at(double t) const { return origin + direction * t; }
};

struct PatchHit {
    double t = 0;
    double a = 0, b = 0;  ///< the patch's parameters, as Patch::at takes them
    SurfacePoint point;   ///< as Patch::at gives it, moved by the offset along the normal
};

/// The first meeting with low < t < high, from either side. `offset` in metres along the normal.
std::optional<PatchHit> intersect(const Patch& patch, const Ray& ray, double low, double high,
                                  double offset = 0);

}  // namespace scancast
