// The border between surfels.cpp and its kernels: plain structs and one table of functions per SIMD level.
// surfel_kernels.cpp is compiled once per level (x86-64-v2, v3, v4); as in renderer/device/cpu/kernels
// nothing that it includes may hold an inline function with external linkage, so: no standard library, no
// GLM.
//
// Every level finds the same neighbours, because "the k nearest" by (squared distance in float, position) is
// one set, and computes the same bytes from them: IEEE's operations in one fixed order.
#pragma once

#include <cstdint>

namespace scancast::surfel {

/// Eight boxes side by side; unused ones are empty (low = +infinity, high = -infinity).
inline constexpr int blockBoxes = 8;
struct BoxBlock {
    float low[3][blockBoxes], high[3][blockBoxes];
};

/// Distinct points in Morton order, cut into leaves, and a hierarchy of boxes over the leaves: each box of a
/// level covers one block of the level below. Owned by NeighbourIndex.
inline constexpr int maxLevels = 12;
struct IndexView {
    const float* x = nullptr;
    const float* y = nullptr;
    const float* z = nullptr;
    std::uint32_t points = 0;
    const std::uint32_t* leafBegin = nullptr;  ///< first point of each leaf, and one past the last
    const BoxBlock* blocks = nullptr;
    std::uint32_t levelBegin[maxLevels] = {};  ///< first block of each level; the last level has one block
    int levels = 0;
};

inline constexpr int maxNeighbours = 80;  ///< beside the point itself
inline constexpr int doublings = 8;       ///< of k = 1: 1, 2, 4 … 128 would be more than maxNeighbours
inline constexpr int groupSize = 16;      ///< queries that share their candidates
inline constexpr int batchLanes = 40;     ///< neighbourhoods waiting to be solved
inline constexpr int capacity = 1024;     ///< candidates of a group; more are not worth ranking
inline constexpr int mostWitnesses = 8;   ///< neighbours that a point's own estimate is held against

struct Neighbourhoods {
    float x[maxNeighbours][batchLanes], y[maxNeighbours][batchLanes], z[maxNeighbours][batchLanes];
    float reach2[batchLanes];     ///< squared distance of the farthest
    float magnitude[batchLanes];  ///< largest coordinate of the point itself: how coarse floats are there
    std::uint32_t point[batchLanes];
    std::uint32_t witness[mostWitnesses][batchLanes];
    int witnesses[batchLanes];
    int count;
};

/// Scratch memory of a thread; holds nothing between calls.
struct SearchScratch {
    float x[capacity + 16], y[capacity + 16], z[capacity + 16], squared[capacity + 16];
    float near[capacity + 16];
    std::uint32_t number[capacity + 16];
    int pick[capacity + 16], found[capacity + 16];
    std::uint32_t ids[maxNeighbours];       ///< of the neighbourhood that is being added
    std::uint32_t best[maxNeighbours + 1];  ///< of a search from the root
    float bestSquared[maxNeighbours + 1];
    float guess[doublings];  ///< squared radius that probably suffices for the next group
    std::uint32_t retry[doublings][groupSize];
    int retries[doublings];
    Neighbourhoods waiting[doublings];
};

/// One surfel, as it leaves the kernels.
struct Solved {
    std::uint32_t point;  ///< in the index' order
    int neighbours;
    float reach2;
    double normal[3];  ///< zero where there is none
    double axis[3];
    float middle
        [3];  ///< of the neighbours and the point itself, from the point: where the normal is the surface's
    double ratio;  ///< λ2 / λ1
    double flat;   ///< λ3 / λ2; 1 where both are 0
    float radius;
    float nearby;   ///< average distance of the nearest mostWitnesses
    bool extended;  ///< the k nearest lie on a line
    bool line;      ///< so do all that were asked
    int witnesses;  ///< of the nearest - where those lie on a line, of the nearest beside it
    std::uint32_t witness[mostWitnesses];
};

struct SurfelKernels {
    /// Surfels of points [begin, end), which `groupBegin[0 … groups]` cuts into groups of at most groupSize.
    void (*solve)(const IndexView&, const std::uint32_t* groupBegin, std::uint32_t groups, int k,
                  SearchScratch&, void (*emit)(void* context, const Solved&), void* context);
    /// The k nearest neighbours of a point into w.best[1 … k]; returns how many there are.
    int (*nearest)(const IndexView&, std::uint32_t point, int k, SearchScratch& w);
};

namespace v2 {
extern const SurfelKernels kernels;
}
namespace v3 {
extern const SurfelKernels kernels;
}
namespace v4 {
extern const SurfelKernels kernels;
}

}  // namespace scancast::surfel
