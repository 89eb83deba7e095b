// A surfel in a sample's four bytes: octahedral normal, log radius, ellipse. Pure functions.
//
// logRadius counts steps of a fixed ratio around the node's spacing (error ≤ 1.2 %); ellipse holds b/a in 3
// bits and the major axis' angle in 5 bits, in the tangent frame that tangentFrame() builds from the
// *decoded* normal.
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "renderer/cloud/sample.hpp"
#include "renderer/cloud/surfel.hpp"
#include "renderer/cloud/surfel_bytes.hpp"

namespace scancast {

/// World radius by logRadius, in the node's radiusUnit; 0 for noRadius, the smallest for outlierRadius.
const std::array<float, 256>& surfelRadii();

/// Right-handed, continuous but for one direction; the same arithmetic in every device.
struct TangentFrame {
    glm::vec3 first, second;
};
TangentFrame tangentFrame(glm::vec3 normal);

/// Directions in a normal's tangent frame that five bits can name, half a turn in all: the one nearest to this axis,
/// whichever way that points; and what it stands for, one unit long.
std::uint8_t axisAngleOf(const glm::vec3& axis, const glm::vec3& normal);
glm::vec3 axisAtAngle(std::uint8_t angle, const glm::vec3& normal);

/// Makes the ellipse of an encoded sample a circle of the same area that is drawn from both sides.
void makeTwoSided(Sample& sample);

/// Sets normal (unless the surfel has none), logRadius and ellipse; nothing else of the sample. Radii outside
/// 1/16 … 16 node spacings and ratios below 1/4 are clamped.
void encodeSurfel(const Surfel& surfel, float nodeSpacing, Sample& sample);
/// The normal stays what `sample` says, (0,0,0) where it has none. Where no radius is known a circle
/// of the node's spacing; for outliers the smallest circle.
Surfel decodeSurfel(const Sample& sample, float nodeSpacing);

}  // namespace scancast
