// `disc` and `ewa`: surfels, the two ways of drawing them; methods.md §5.
//
// `disc`, 002_e37b3096399c9e96 ("Point-based Rendering", a blog), from the page to the code:
//   page                                                    here
//   "Calculating Splat Radii": mean distance to the 8-10    Surfel::radius
//   (renderer/cloud/surfels/surfels.hpp), at
//     nearest points                                          ingest
//   geometry shader: a quad in the tangent plane            Footprint::Disc: the exact outline, by the
//   plane's fragment shader: discard outside the circle               intersection with the ray of each pixel
//   splatSize, a uniform                                    parameter `scale`; 1 is the radius itself (the
//                                                           page's quad has half of it, which leaves holes)
//   "omits all points whose splat radius is 0"              outliers (surfel_codec.hpp) are not drawn
//   depth test of the fragments                             NearestPass: the depth of the plane, per pixel
//
// `ewa`, 001_c3e54385a9f0e90c ("Achieving a Smooth Interpolation between the Points Using Modified Rendering
// Algorithm") with Zwicker et al., "Surface Splatting", 2001:
//   paper                                                   here
//   §IV-c, Algorithm 2: axes by principal components        Surfel::major, minor, at ingest
//   Algorithm 3, line 7: "projected reconstruction kernel   Footprint::Ellipse: Σ through the Jacobian of the
//     * UnitGaussian"                                         view, and the screen's low-pass added
//   line 8: "Rasterize and accumulate splat"                SumPass: w = sqrt(|JΣJᵀ|/|V|)·exp(-½ xᵀV⁻¹x)
//   lines 15-17: "for each output pixel: normalize"         ResolvePass with sums
//   §III: "Aliasing artifacts are not handled" (QSplat)     parameter `lowPass`: textures seen small are
//                                                           averaged
//   visibility, which the paper leaves to Zwicker's         NearestPass, and SumPass' tolerance of 2a + 2dz
//     ε-z-buffer                                              behind it
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
