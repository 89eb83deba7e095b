// A mesh of a surface that is given by its signed distance: a naive surface net, one vertex for every cell of
// a lattice that the surface goes through, moved onto the surface, with the normal that the distance has
// there.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

namespace scancast {

struct SurfaceMesh {
    std::vector<glm::vec3> position, normal;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counterclockwise seen from outside
};

/// Negative inside. Where the surface is more than `trust` times its value away, nothing is looked for: 1 for
/// a true distance, 0.5 for one that may be twice too large.
using SignedDistance = std::function<float(const glm::vec3&)>;

/// Unit gradient by central differences.
glm::vec3 outwardNormal(const SignedDistance& distance, const glm::vec3& at);

/// Inside the box, cells of edge `cell`. Deterministic; uses all cores of the caller's arena.
SurfaceMesh surfaceNet(const SignedDistance& distance, const glm::vec3& low, const glm::vec3& high,
                       float cell, float trust);

}  // namespace scancast
