// `hqs`, high-quality splatting: overlapping circles are blended instead of cut at each other. The comparator
// of 000_7b007f61d09f0b1b, "High-Quality Point-Based Rendering Using Fast Single-Pass Interpolation", §V;
// methods.md §4.
//
// From the paper to the code:
//   paper                                                   here
//   "first pass ... depth buffer"                           NearestPass, flat circles: the visible surface
//   d_vis "second pass ... accumulates weighted colors of all     SumPass: w = (1-(u²+v²))^1.5 where
//     fragments within a small distance ε of the depth"       d ≤ d_vis + ε, ε = 2R
//   "third pass normalizes"                                 ResolvePass with sums
//   depth moved by ε in the first pass                      added in the second: frames keep the true depth
#pragma once

#include "renderer/method/method.hpp"

namespace scancast {

Method hqsMethod();

}  // namespace scancast
