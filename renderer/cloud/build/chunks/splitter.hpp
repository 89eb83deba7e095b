// Splitting a set of points in place into octants at its average position. docs/spec/hierarchy.md §2.
// Pipeline: staging → **splitter** → leaves. Pure functions on a run of points; large runs are measured in
// parallel.
#pragma once

#include <span>

#include "renderer/cloud/build/grid.hpp"

namespace scancast {

/// From this level on sets are split at the middle of their box. The average separates any two points too,
/// but how many levels it takes is up to the points; the middle takes at most gridBits more, so levels end
/// below 83.
inline constexpr int lastAverageLevel = 40;

struct Measure {
    GridBox box;
    GridPosition average{};  ///< rounded down
};
Measure measure(std::span<const BuildPoint> points);

struct Octants {
    /// Octant i is points[first[i]] … points[first[i + 1] - 1]; some are empty.
    std::array<std::size_t, 9> first{};
};

/// Reorders the points so that octants follow each other. An axis along which the set is flat - it spreads
/// less than a quarter as far as along the widest axis - is not split: it would cut a noisy surface into two
/// interleaved, thinner ones. At least two octants are not empty unless all points are equal.
Octants split(std::span<BuildPoint> points, const Measure& measure, const Grid& grid, int level);

}  // namespace scancast
