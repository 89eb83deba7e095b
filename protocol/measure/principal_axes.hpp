// The directions in which points lie spread out, and with them the plane that fits them best: eigenvectors of a symmetric 3 × 3
// matrix. Pure functions; any thread.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

namespace scancast {

struct PrincipalAxes {
    glm::dvec3 center{0};  ///< weighted mean
    /// Unit vectors, right-handed, the direction of the least spread first: the normal of the best-fit plane (least squares of the
    /// distances at right angles to it).
    std::array<glm::dvec3, 3> axes{glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};
    std::array<double, 3> variances{};  ///< along them, ascending; ≥ 0
};

/// Of at least one point. `weights`: one each, ≥ 0, not all 0; empty = all alike.
PrincipalAxes principalAxes(std::span<const glm::dvec3> points, std::span<const double> weights = {});

}  // namespace scancast
