// Patches: sets of neighbouring positions whose normals are known to point to one side of one surface, whichever
// that is. Neighbours' normals are made to agree along the links of a forest that takes the best links first.
// Pipeline: evidence of one chunk → **patches** → facets (renderer/cloud/build/sides) → sides.
// Source: Hoppe et al., "Surface Reconstruction from Unorganized Points", 1992; docs/spec/surfels.md §9.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "renderer/cloud/surfel.hpp"
#include "renderer/cloud/surfels/evidence.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"

namespace scancast {

inline constexpr std::uint16_t noPatch = 0;

/// Of a chunk's own points.
struct SidePatches {
    struct Patch {
        std::uint32_t points = 0;
        std::uint32_t links = 0, contradictions = 0;  ///< between its points; those that say the opposite
    };
    /// What all links between two patches say together.
    struct Border {
        std::uint16_t low, high;  ///< numbers
        float same = 0, opposite = 0;
    };
    std::vector<std::uint16_t> of;  ///< of each point; noPatch = none
    std::vector<Patch> patches;     ///< number i is patches[i - 1]; in the order of their first points
    std::vector<Border> borders;    ///< in the order of low and high
};

/// What two places with normals say of each other.
struct SideLink {
    float quality = 0;      ///< 0 nothing … 1 beyond doubt
    bool opposite = false;  ///< one of the normals has to be turned for both to be on one side
};

/// Two normals are on one side if one, mirrored in the plane midway between the places, is near the other: on
/// planes, arcs, and across creases, too.
SideLink linkBetween(const glm::vec3& from, const glm::vec3& fromNormal, const glm::vec3& to,
                     const glm::vec3& toNormal);

/// Finds the patches of the first surfels.size() points of the index' and turns the normals of each to one side.
/// Depends on the set of points alone, in whatever order.
SidePatches findPatches(const NeighbourIndex& index, const Evidence& evidence, std::span<Surfel> surfels);

}  // namespace scancast
