// Principal curvatures of the surface at a sample, in four bytes beside its sixteen: the plane "curvature" of a
// cloud file (file/CLOUD_FILE.md), which comes into memory and onto devices with the samples. Pure functions.
// Source: Kalaiah and Varshney, "Differential Point Rendering", 2001; docs/spec/surfels.md §11.
//
// Curvature is how much the normal turns on the way along a direction: dN(e) = k · e. So it is positive where the
// surface turns away from its normal - a ball of radius R whose normals point outwards has 1/R - and changes its
// sign with the normal.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "renderer/cloud/sample.hpp"
#include "renderer/cloud/surfel.hpp"

namespace scancast {

/// Byte 0 and 1: k1 and k2, |k1| >= |k2|, in curvatureSteps() times 1 / the node's radiusUnit. Byte 2: the angle of k1's
/// direction, 0 - 31 times 180° / 32, in the tangent frame of the *decoded* normal, as an ellipse's is. Byte 3: 0; beside a
/// sample in memory something else stands there (beside.hpp).
/// All bytes 0: flat, or nobody knows.
using CurvatureCode = std::uint32_t;

struct Curvature {
    float k1 = 0, k2 = 0;    ///< 1 / cloud units; |k1| >= |k2|
    glm::vec3 direction{0};  ///< of k1; unit, in the surface; (0,0,0) where both are 0
};

/// Curvature by byte, in 1 / radiusUnit: 0, then 2^-10 … 4 in steps of 2^(1/8); negative from 128 on.
const std::array<float, 256>& curvatureSteps();

/// Of an estimated surfel (Surfel::bend), relative to its estimated normal.
Curvature curvatureOf(const Surfel& surfel);

/// `curvature` counts from `estimated`, the normal that it was estimated with; the code counts from `decoded`, the
/// sample's own. No curvature is larger than 1 / radius: a splat of that radius would turn by more than it sees; what turns by less than
/// half a degree from its centre to its border is flat.
CurvatureCode encodeCurvature(const Curvature& curvature, const glm::vec3& estimated,
                              const glm::vec3& decoded, float radius, float radiusUnit);
/// Of a surfel with its estimated normal, for the sample that it became. Wires, foliage and strays have none: they are
/// no surface.
CurvatureCode curvatureCodeOf(const Surfel& surfel, const Sample& sample, float radiusUnit);
/// Of any code: bytes that nobody writes stand for the nearest that somebody does.
Curvature decodeCurvature(CurvatureCode code, const glm::vec3& decoded, float radiusUnit);

/// The same surface seen from behind: the code relative to another decoded normal, on the other side.
CurvatureCode turnedOver(CurvatureCode code, const glm::vec3& decoded, const glm::vec3& other);

}  // namespace scancast
