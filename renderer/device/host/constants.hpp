// The numbers of formulas/constants.inl for C++: of internal linkage, because SIMD kernels include this (decision 2).
#pragma once

namespace scancast {

#define CONSTANT constexpr
#include "renderer/device/formulas/constants.inl"
#undef CONSTANT

static_assert(stepPerNormal == 1 / normalStepsOfSurface && halfPerStep == 1 / offsetSteps);
static_assert(toleranceBase == (127 - 8) << 23 && leastTolerance == 1.0f / 256);
static_assert(blendPerStep == 2.0f / (normalStepsOfSurface * normalStepsOfSurface) &&
              agreementPerStep == blendPerStep);
static_assert(placeStep * placeSteps == 1);
static_assert(creasePriority == 1.0f / 4096 && edgePerStep == 4.0f / normalStepsOfSurface);

}  // namespace scancast
