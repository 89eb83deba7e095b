// Where the sun looks from, so that what it sees is the map of shadows of a picture (docs/spec/shading.md §10). Pure
// functions; any thread. Pipeline: plan → **the sun's viewpoint** → prepare → device.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>

#include "renderer/select/viewpoint.hpp"

namespace scancast {

/// Of a map of shadows, px; it is at most twice as large as the picture, too.
inline constexpr int smallestShadowMap = 256, largestShadowMap = 2048;

/// Without perspective, along the sun's rays: all of the bounds (cloud-relative) that the picture shows, and whatever
/// lies between that and the sun. Its pixels lie where those of another picture's map lie, as long as they are as large:
/// shadows stand still while the viewer moves. nullopt: the picture shows nothing of the bounds.
std::optional<Viewpoint> sunViewpoint(const std::array<glm::dvec3, 2>& bounds, const Viewpoint& picture,
                                      const glm::dvec3& wayToSun);

}  // namespace scancast
