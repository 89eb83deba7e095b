// Inverse depth as whole numbers, and what the cells before it say of a cell's. PROTOCOL.md, "Depth of a frame", is the
// reference for readers of other languages. Pure functions.
//
// Inverse, because that is linear in the picture of a plane. A code is a floating-point number of nine bits - within an
// octave it is linear, too - so that the error is at most 1/1024 of any depth: what a point's picture moves, when the eye
// moves, is off by that share, be it near or far. Even steps from 1/near to 1/far would have to be as small as the
// farthest point's, and would code the noise of all nearer ones (docs/decisions/022-depth-in-nine-bits.md).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace scancast::depth_codes {

inline constexpr int mantissa = 9;    ///< bits that each octave has
inline constexpr int unitBits = 24;   ///< 1/near is 2^24 units
inline constexpr int nearest = 8192;  ///< the code of 1/near; the least one is 1

/// Of near/depth, in (0, 1]. The relative error is 2^-10 down to 2^-15, and grows beyond.
inline int codeOf(double relative) {
    const double units = std::ldexp(std::clamp(relative, 0.0, 1.0), unitBits);
    if (units < 1) return 1;
    const int octave = std::max(0, std::ilogb(units) - mantissa);
    return (octave << mantissa) + int(std::lround(std::ldexp(units, -octave)));
}

/// near/depth of a code in [1, nearest].
inline double relativeOf(int code) {
    const int octave = std::max(0, (code >> mantissa) - 1);
    return std::ldexp(double(code - (octave << mantissa)), octave - unitBits);
}

/// From the cells left of a cell, above it, and above the left one: the plane through them, but within what the first two
/// are, so that an edge is taken for one.
inline int predicted(int left, int above, int corner) {
    return std::clamp(left + above - corner, std::min(left, above), std::max(left, above));
}

/// 0, -1, 1, -2 … as 1, 2, 3, 4 …: 0 is left for background.
inline int symbolOf(int difference) {
    return difference >= 0 ? 2 * difference + 1 : -2 * difference;
}
inline int differenceOf(int symbol) {
    return symbol % 2 == 1 ? symbol / 2 : -(symbol / 2);
}

static_assert((((unitBits - mantissa) << mantissa) + (1 << mantissa)) == nearest);
static_assert(2 * nearest + 1 <= 65535);

}  // namespace scancast::depth_codes
