// Surfels: what a point's neighbours tell of the surface at it - normal, half-axes, radius, and whether it is
// an outlier. Pipeline: leaves of one chunk → **surfels** → averages; and inner nodes' samples → **surfels**
// → cloud. Source: docs/spec/surfels.md §2. Pure
// functions; use the caller's TBB arena; the result depends on the set of points alone, not on threads.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>

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
    bool outlier = false;    ///< r > 4 × the median of its neighbours' r
};

struct SurfelOptions {
    int neighbours = 10;  ///< k; doubled up to 80 while λ2/λ1 < 1/16 (scan lines)
};

/// Of the first out.size() points; the rest (a halo) only lends neighbours. Points are offsets from a nearby
/// origin, in cloud units; faster when neighbours stand together (Morton order).
void estimateSurfels(std::span<const glm::vec3> points, const SurfelOptions& options, std::span<Surfel> out);

}  // namespace scancast
