// Sprites: a point is a small screen-aligned shape, drawn in one `nearest` pass. `point`, `square`, `circle`,
// and the shapes that bulge towards the eye, `paraboloid`, `cone`, `sphere`, so that neighbours share the
// picture between them like cells of a Voronoi diagram instead of hiding each other. docs/spec/sprites.md §1.
// Source:
// Schütz and Wimmer, "High-Quality Point-Based Rendering Using Fast Single-Pass Interpolation", 2015, §III.
//
//   paper                                        here
//
//   §III, Fig. 1: weights over u, v ∈ [-1, 1]    Profile (renderer/device/pass.hpp)
//   §III: fragments outside the sphere go        Footprint::Circle; paraboloid and cone also on Square
//   §III-A: world radius ↔ pixel size            SplatSize; R = (p/2)/q(d)
//   §III-A: at most 50 pixels                    parameter maxPx, 50
//   §III-A, listing: pos.z += w · vRadius        order = d + gain·(1-w)·R. The border is pushed back and the
//                                                centre stays where the scanner saw it; with equal radii this
//                                                is the paper's picture, with unequal ones a large sparse
//                                                splat cannot break through a dense surface. The listing's
//                                                vRadius is a diameter: hence gain 2.
//   (not in the paper)                           ResolvePass::smooth; docs/spec/sprites.md §9
//   §V: no early depth test                      does not hold here: no fragment lies in front of its centre,
//                                                so a device may skip splats that lie wholly behind what it
//                                                has drawn.
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
