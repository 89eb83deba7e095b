// Which compilation of the surfels' kernels runs here. Any thread.
#pragma once

#include <span>
#include <vector>

#include "renderer/cloud/surfels/kernels/surfel_kernels.hpp"
#include "renderer/cloud/surfels/surfels.hpp"

namespace scancast {

/// All that this processor can run, the best first. They give the same surfels.
std::vector<const surfel::SurfelKernels*> availableSurfelKernels();

/// The best, or the one that SCANCAST_SIMD (v2, v3, v4) names, where the processor knows it; the cpu device
/// obeys the same variable.
const surfel::SurfelKernels& surfelKernels();

/// estimateSurfels() by one of them, for comparing.
void estimateSurfels(std::span<const glm::vec3> points, const SurfelOptions& options, std::span<Surfel> out,
                     const surfel::SurfelKernels& kernels);

}  // namespace scancast
