// `disc` and `ewa`: surfels, the two ways of drawing them.
//
// `disc`, docs/spec/surfels.md §3, after Broecker, "Point-based Rendering", undated:
//
//   page                                         here
//
//   radius: mean distance to the 8-10 nearest    Surfel::radius (surfels/surfels.hpp), at ingest
//   geometry shader: a quad in the plane         Footprint::Disc: the exact outline, by the intersection of
//   fragment shader: outside the circle, drop      the plane with the ray of each pixel
//   splatSize, a uniform                         parameter `scale`; 1 is the radius itself (the page's quad
//                                                has half of it, which leaves holes)
//   points whose radius is 0 are left out        outliers (surfel_codec.hpp) are not drawn
//   depth test of the fragments                  NearestPass: the depth of the plane, per pixel
//
// `ewa`, docs/spec/surfels.md §4, after Kaushik, Nagwanshi and Sharma,
// "Achieving a Smooth Interpolation between the Points Using Modified Rendering Algorithm", undated, §IV, and
// Zwicker et al., "Surface Splatting", 2001:
//
//   paper                                        here
//
//   Algorithm 2: axes by principal components    Surfel::major, minor, at ingest
//   Algorithm 3, line 7: kernel * Gaussian       Footprint::Ellipse: Σ through the Jacobian of the view, and
//                                                the screen's low-pass added
//   line 8: rasterize, accumulate                SumPass: w = sqrt(|JΣJᵀ|/|V|)·exp(-½ xᵀV⁻¹x)
//   lines 15-17: normalize every pixel           ResolvePass with sums
//   §III: QSplat's aliasing                      parameter `lowPass`: textures seen small are averaged
//   §IV-b: circular splats, what ellipses are      parameter `shape=circle`: of the larger half-axis, which is
//     compared with                                §IV-a's radius, the distance to the k-th neighbour
//   visibility, left to Zwicker's ε-z-buffer     NearestPass, and how far both surfels say that theirs reaches
#pragma once

#include <string>
#include <vector>

#include "renderer/method/method.hpp"

namespace scancast {

Method discMethod();
Method ewaMethod();

/// Shared by the methods that draw surfels: `scale`, `maxPx`, `cull`.
std::vector<Parameter> surfelParameters();
Splat surfelSplat(Footprint footprint, const ParameterValues& values);

}  // namespace scancast
