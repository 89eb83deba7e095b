// Strays: single positions and small groups that are far from everything else. Pure function of the positions
// and their radii. Pipeline: part of surfels. Source: docs/spec/surfels.md §8.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/cloud/surfels/evidence.hpp"
#include "renderer/cloud/surfels/kernels/surfel_kernels.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"

namespace scancast {

/// A stray is, with the g - 1 nearest to it (g ≤ 32), farther from the next position than `farFactor` times the
/// distance to the farthest of them, and than `farFactor` times the median radius of the (up to) eight next.
inline constexpr int mostStraysTogether = 32;
inline constexpr float farFactor = 16;

/// Whether a position is one. Searches: only for those that findStrays() has reason to suspect.
bool isStray(std::uint32_t p, const NeighbourIndex& index, const Evidence& evidence,
             const surfel::SurfelKernels& kernels, surfel::SearchScratch& scratch);

/// Adds the strays of positions [begin, end) of the index' order. Whoever is far from everything else stands in
/// few cells by itself: in the order there is a gap before and after each part of the group.
void findStrays(std::uint32_t begin, std::uint32_t end, const NeighbourIndex& index, const Evidence& evidence,
                const surfel::SurfelKernels& kernels, surfel::SearchScratch& scratch,
                std::vector<std::uint32_t>& strays);

}  // namespace scancast
