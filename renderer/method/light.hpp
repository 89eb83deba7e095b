// From a view's light to the passes that light: shares become factors that keep a scene as bright, on the whole, as
// its colours are, whoever looks at it from wherever. docs/spec/shading.md §2. Pure functions; any thread.
// Pipeline: view → **light** → a method's passes.
#pragma once

#include <glm/vec3.hpp>

#include "protocol/view/view.hpp"
#include "renderer/device/pass.hpp"

namespace scancast {

/// The way to the sun, in the file's axes, unit length. North is the file's +Y as far as it lies flat; where `up`, a
/// unit vector, is ±Y, it is ∓Z. East is to the right of who looks north.
glm::dvec3 wayToSun(const std::array<double, 2>& azimuthElevation, const glm::dvec3& up);
/// Its inverse, to whole degrees: where a sun stands that shines from there. `way` is not 0.
std::array<double, 2> sunAlong(const glm::dvec3& way, const glm::dvec3& up);

/// `up`: of the cloud. Without any light, all is black.
PhongPass phongPass(const LightRig& light, const glm::dvec3& up);

/// Whether something is in the sun's shadow.
bool castsShadows(const LightRig& light);
/// Without its bias, which depends on what the sun sees (renderer/sun.hpp).
ShadowPass shadowPass(const LightRig& light, Shading shading);
/// `height`: of the whole picture, px, so that a picture has the same shades at any size.
OcclusionPass occlusionPass(const LightRig& light, int height);

}  // namespace scancast
