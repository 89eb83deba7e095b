// Surfels: what a point's neighbours tell of the surface at it - normal, half-axes, radius, density, and whether it
// is an outlier. Pipeline: leaves of one chunk → **surfels** → averages; and inner nodes' samples → **surfels**
// → cloud. Source: docs/spec/surfels.md §2, §8. Pure
// functions; use the caller's TBB arena; the result depends on the set of points alone, not on threads.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>

#include "renderer/cloud/surfel.hpp"

namespace scancast {

struct SidePatches;  // patches.hpp

struct SurfelOptions {
    int neighbours = 10;  ///< k; doubled up to 80 while λ2/λ1 < 1/16 (scan lines)
    /// Of the nodes that the points are drawn with, one for each of `out`: a surface that is much sparser has to
    /// have more evidence. Empty: all have to.
    std::span<const float> spacings = {};
    /// Where to put which of the points' normals agree on a side; those are turned to it. Null: not wanted, and
    /// the normals' signs say nothing.
    SidePatches* patches = nullptr;
    bool bends = false;   ///< how the surface bends (§11)
    bool layers = false;  ///< see through the steps of scans that stand in layers (§10)
};

/// Of the first out.size() points; the rest (a halo) only lends neighbours. Points are offsets from a nearby
/// origin, in cloud units; faster when neighbours stand together (Morton order).
void estimateSurfels(std::span<const glm::vec3> points, const SurfelOptions& options, std::span<Surfel> out);

}  // namespace scancast
