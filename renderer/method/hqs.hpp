// `hqs`, high-quality splatting: overlapping circles are blended instead of cut at each other.
// docs/spec/sprites.md §6. Source: the three passes that
// Schütz and Wimmer, "High-Quality Point-Based Rendering Using Fast Single-Pass Interpolation", 2015, §II-A
// describes and §IV compares itself with.
//
//   paper                                        here
//
//   first pass: a depth map                      NearestPass, flat circles: the visible surface d_vis
//   second pass: a weighted sum of what          SumPass: w = (1-(u²+v²))^1.5 where d ≤ d_vis + ε, ε = 2R
//     passes the depth test
//   third pass: division by the sum of weights   ResolvePass with sums
//   the depth map has a small offset             added in the second pass: frames keep the true depth
#pragma once

#include "renderer/method/method.hpp"

namespace scancast {

Method hqsMethod();

}  // namespace scancast
