// How the surface bends at every position: the shape operator, fitted to how the neighbours' normals turn. Pipeline:
// normals → **shape operator** → sides. Source: docs/spec/surfels.md §11.1.
#pragma once

#include <span>

#include "renderer/cloud/surfel.hpp"
#include "renderer/cloud/surfels/evidence.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"

namespace scancast {

/// Of positions [begin, end): sets `bend` of the surfels that stand there. Expects all normals, of whatever sides, in the
/// evidence, and the surfels' own with their major axes. Several threads may call it for ranges of their own.
void estimateBends(std::uint32_t begin, std::uint32_t end, const NeighbourIndex& index,
                   const Evidence& evidence, std::span<Surfel> surfels);

}  // namespace scancast
