// What a surfel's bytes stand for, wherever they are read: the codec, the kernels, the shaders. Constants and
// nothing else, because SIMD kernels include this (decision 2).
#pragma once

#include <cstdint>

namespace scancast {

inline constexpr std::uint8_t noRadius = 0;         ///< not known: the node's spacing stands in
inline constexpr std::uint8_t outlierRadius = 255;  ///< an outlier: not drawn unless asked for

/// The k-th neighbour's distance over the neighbours' average distance: how `major` follows from `radius`.
/// The median of real scans (docs/decisions/005-surfel-in-four-bytes.md).
inline constexpr float majorPerRadius = 1.36f;

/// A circle whose normal may point to either side, in a node whose others point to the side that was scanned. Other
/// circles are 0.
inline constexpr std::uint8_t twoSidedCircle = 1;

/// b/a of an ellipse is 1 less so many of these, 0 to 7.
inline constexpr float axisRatioStep = 0.75f / 7;

}  // namespace scancast
