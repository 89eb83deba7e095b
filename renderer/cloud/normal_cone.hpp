// Cones around normals, for culling nodes that face away. Pure functions. Pipeline: samples → **cones** →
// nodes. Source: Kaushik, Nagwanshi and Sharma, "Achieving a Smooth Interpolation between the Points Using
// Modified Rendering Algorithm", undated, §IV-b; docs/spec/hierarchy.md §4.
//
// Conservative: what went in lies within, up to 1e-6 rad. Nearly the smallest cone: within 5 % of it, or
// 0.5°.
#pragma once

#include <span>

#include "renderer/cloud/octree.hpp"

namespace scancast {

/// Around unit vectors. Unknown (halfAngle ≥ π) where there are none, or one of them is no direction (0,0,0).
NormalCone coneOf(std::span<const glm::vec3> normals);

/// Around cones, each joined to those before. Unknown where there are none, or one is, or nothing less than
/// all directions holds them.
NormalCone join(std::span<const NormalCone> cones);

}  // namespace scancast
