// `pyramid`, deferred shading of raw points: one pixel a point, and everything else is done to the picture.
// Needs neither normals nor radii, and its cost does not depend on the number of points.
// docs/spec/pyramid.md §1. Source: Bouchiba, Deschaud and Goulette,
// "Raw point cloud deferred shading through screen space pyramidal operators", 2018, §3.
//
//   paper                                        here
//
//   §3: one pixel per point                      NearestPass, Footprint::Pixel, and ResolvePass
//   §3: s0, an approximate metric scale          parameter spacing; else the cloud's own. Sizes use
//                                                s_eff = max(s0, 2τ/q): levels of detail thin out
//   §3.1.1 point cloud pyramid                   kernels/point_pyramid.hpp
//   §3.1.2, Fig. 3, eq. 1: occlusion in          HiddenPointsPass; kernels/hidden_points.hpp. Parameters
//     8 sectors, s_hpr = 10 s0, threshold 0.1    hprScale and threshold. hprScale is 5: it removes as much
//                                                of the rear of two sheets as 10 does, closes windows half as
//                                                wide, and views of a town are 0 to 0.5 dB nearer to a dense
//                                                picture of it
//   §3.1.2: background tested for occlusion      closing of the points by discs; kernels/closing.hpp. Tested by
//     at the far plane                           occlusion, outlines frayed and slabs stood beside poles. Where
//                                                discs would be too wide: occlusion, at infinity on its own ray
//   Fig. 2b: the mask                            `color=visibility`: VisibilityPass ends the list
//   Fig. 4: fixed neighbourhoods, before         parameter hprPx; HiddenPointsPass::fixedPx
//   Fig. 5a: normals of level 0                  parameter normalScale, near 0
//   -                                            parameters minGap and noise, measured where not given: points
//                                                just in front of others are the same surface
//   §3.2 pull-push, the background put back      PullPushPass; kernels/pull_push.hpp. Not mixing depths
//                                                across steps was tried: outlines became blocks, 0.3 dB
//                                                worse
//   §3.3 pyramidal normals                       DepthNormalsPass; kernels/depth_normals.hpp. Parameter
//                                                normalScale; by default as the noise asks for
//   deferred shading                             what the request's shading adds
#pragma once

#include "renderer/method/method.hpp"

namespace scancast {

Method pyramidMethod();

}  // namespace scancast
