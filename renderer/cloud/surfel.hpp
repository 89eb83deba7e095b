// What a point's neighbours tell of the surface at it, as a plain value (renderer/cloud/surfels/ estimates
// it, surfel_codec.hpp puts it into a sample).
#pragma once

#include <glm/vec3.hpp>

#include "renderer/cloud/density.hpp"

namespace scancast {

/// minor / major of a surfel is never less: a longer ellipse is measured from too few neighbours.
inline constexpr float leastSurfelRatio = 0.25f;

struct Surfel {
    glm::vec3 normal{
        0};  ///< unit; sign arbitrary; (0,0,0) where the points tell none (fewer than 3, or all on a line)
    glm::vec3 majorAxis{0};  ///< unit, in the surface
    float major = 0;         ///< a: distance to the k-th nearest distinct neighbour, cloud units
    float minor = 0;         ///< b = a · max(√(λ2/λ1), 1/4)
    float radius = 0;        ///< r: average distance to those k neighbours; 0 = no neighbour
    float nearby = 0;        ///< average distance to the eight nearest of them
    float usual = 0;         ///< the median of its witnesses' r (surfels/evidence.hpp); 0 = not known
    /// How the normal turns, 1 / cloud units: dN = (x, y; y, z) in majorAxis and normal × majorAxis. 0 where it does not,
    /// or no more than noise explains (curvature.hpp).
    glm::vec3 bend{0};
    float rough = 0;         ///< of foliage: 1 in the middle of a rough surface, 0 of leaves
    Density density = Density::Surface;
    bool outlier = false;  ///< its density is Stray
};

/// The same surfel with its normal on the other side.
inline void turnNormal(Surfel& surfel) {
    surfel.normal = -surfel.normal;
    surfel.bend = {-surfel.bend.x, surfel.bend.y, -surfel.bend.z};
}

}  // namespace scancast
