// Points of a batch to bytes, block by block on all cores; the blocks stand in their order. Pipeline: batch → **bytes** →
// output.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

namespace scancast {

inline constexpr std::size_t exportBlockPoints = 4096;

/// Calls encode(block, first, end) for each.
template <class Encode>
void inBlocks(std::size_t points, Encode encode) {
    const std::size_t blocks = (points + exportBlockPoints - 1) / exportBlockPoints;
    tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
        const std::size_t first = block * exportBlockPoints;
        encode(block, first, std::min(points, first + exportBlockPoints));
    });
}

}  // namespace scancast
