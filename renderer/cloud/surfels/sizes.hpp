// How large a sample may be drawn, by its density: large is only what has evidence of a plane. Pure functions.
// Pipeline: surfels → **sizes** → samples, of leaves and of inner nodes. Source: docs/spec/surfels.md §8.
#pragma once

#include "renderer/cloud/surfel.hpp"

namespace scancast {

/// The largest radius of a surfel of this density, whatever its own estimate says; `levelSpacing` is the
/// spacing of the node that it is drawn with.
float largestRadius(const Surfel& surfel, Density density, double levelSpacing);

/// Radius and half-axes, in proportion, so that the radius is at most this.
void shrink(Surfel& surfel, float largest);

}  // namespace scancast
