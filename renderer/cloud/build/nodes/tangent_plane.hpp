// The plane that a handful of points lie nearest to. Pure function, in double precision and in a fixed order
// of operations. Spacing is measured in it (spacing.cpp); surfels have kernels of their own.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

namespace scancast {

struct TangentPlane {
    glm::dvec3 first{1, 0, 0}, second{0, 1, 0};  ///< principal directions, unit length
    std::array<double, 3> variance{0, 0, 0};     ///< along first, second and the normal; descending
};

/// Of the offsets and the origin they count from, about their common centroid.
TangentPlane tangentPlane(std::span<const glm::vec3> offsets);

}  // namespace scancast
