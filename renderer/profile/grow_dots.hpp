// Dots of a profile's picture that lie apart grow until they touch, so that sparse scans can be read; those of dense ones stay as they are.
// Pure; any thread. The same pixels give the same pixels. Pipeline: points of one pixel each → **grown dots** → frame.
#pragma once

#include <cstdint>
#include <vector>

namespace scancast {

/// No dot grows larger, px.
inline constexpr int mostGrownDot = 8;

/// The side, in px, up to which dots of a scan grow: one and a half times its `spacing`, at `perUnit` px a file unit; 1: not at all.
int mostDotSide(double spacing, double perUnit);

/// Each pixel that is not 0 becomes a square whose side is its distance, the larger of across and down, to the second nearest pixel that is
/// not 0, `most` at the most: what lies in a row touches on both sides, and what has two neighbours beside it does not grow. Where squares
/// overlap, the largest value is in front. An even side reaches farther to the right and down. `pixels`: row by row, from the top.
/// `most` is up to mostGrownDot.
void growDots(std::vector<std::uint64_t>& pixels, int width, int most);

}  // namespace scancast
