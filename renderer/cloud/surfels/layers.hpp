// Normals of scans that see depth in steps - cameras whose disparities are whole numbers - and so stand in layers, farther
// apart than the points in them: each is a plane of its own to a point's neighbours. Used by estimateSurfels() once all
// neighbourhoods are known; uses the caller's TBB arena. Pipeline: evidence → **layers** → surfels. Source:
// docs/spec/surfels.md §10.
#pragma once

#include <span>

#include "renderer/cloud/surfel.hpp"
#include "renderer/cloud/surfels/evidence.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"

namespace scancast {

/// Where the positions stand in layers of one coordinate, surfels and evidence get the normals of the planes that go
/// through several layers, and surfels become circles; all others stay as they are. `surfels`: of the first points of the index.
void seeThroughLayers(const NeighbourIndex& index, Evidence& evidence, std::span<Surfel> surfels);

}  // namespace scancast
