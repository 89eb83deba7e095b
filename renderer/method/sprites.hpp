// Sprites: a point is a small screen-aligned shape, drawn in one `nearest` pass. `point`, `square`, `circle`,
// and the shapes that bulge towards the eye, `paraboloid`, `cone`, `sphere`, so that neighbours share the
// picture between them like cells of a Voronoi diagram instead of hiding each other. Source:
// 000_7b007f61d09f0b1b, "High-Quality Point-Based Rendering Using Fast Single-Pass Interpolation"; methods.md
// §3.
//
// From the paper to the code:
//   paper                                                   here
//   §III, Fig. 1: weight functions over u, v ∈ [-1, 1]      Profile (renderer/device/pass.hpp)
//   §III: "fragments outside the sphere are discarded"      Footprint::Circle; paraboloid and cone also on
//   Square §III-A: world radius ↔ pixel size by the projection     SplatSize; R = (p/2)/q(d) §III-A: "our
//   implementation limits the point size to    parameter maxPx, 50
//     a maximum of 50 pixels"
//   §III-A, listing: pos.z += w · vRadius                   order = d + gain·(1-w)·R. The border is pushed
//   back and
//                                                           the centre stays where the scanner saw it; with
//                                                           equal radii this is the paper's picture, with
//                                                           unequal ones a large sparse splat cannot break
//                                                           through a dense surface. The listing's vRadius is
//                                                           a diameter: hence gain 2.
//   §V: overdraw "does not allow for early depth testing"   does not hold here: no fragment lies in front of
//   its
//                                                           centre, so a device may skip splats that lie
//                                                           wholly behind what it has drawn.
#pragma once

#include <vector>

#include "renderer/method/method.hpp"

namespace scancast {

/// sizePx, scale, minPx and maxPx, for all screen-aligned splats, and what they say.
std::vector<Parameter> sizeParameters();
SplatSize sizeOf(const ParameterValues& values);

/// The six sprites, best first.
std::vector<Method> spriteMethods();

}  // namespace scancast
