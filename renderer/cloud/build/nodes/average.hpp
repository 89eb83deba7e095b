// Averaged samples: what inner nodes hold. Sums are integers, so an average over averages is the exact
// average over the scan's points, in any order. Pipeline: leaves → **averages** → octree.
//
// A cell of 2^cellLevel grid steps, anchored at the grid's 0, gives one sample; two where normals point to
// opposite sides (a thin wall): they are averaged sign-free first, and what points more than 90° away from
// that direction - with a margin for noise - becomes the second sample. Normals without an orientation are
// turned to one side instead.
#pragma once

#include <span>

#include "renderer/cloud/beside.hpp"
#include "renderer/cloud/build/grid.hpp"
#include "renderer/cloud/sample.hpp"

namespace scancast {

__extension__ using WideSum = unsigned __int128;  // 42 bits times the number of points

struct Vote {
    std::uint8_t classification;
    std::uint64_t count;
};

struct Average {
    GridPosition cell{};  ///< index of the cell at the list's cellLevel
    std::array<WideSum, 3> position{};
    std::uint64_t count = 0;  ///< scan points
    std::array<std::uint64_t, 3> color{};
    std::uint64_t intensity = 0, nearInfrared = 0;
    std::array<std::int64_t, 3> normal{};  ///< sum of unit normals, 12 bits each
    std::array<std::uint64_t, 3> bulks{};  ///< scan points that are wires, foliage, strays
    float reach = 0;  ///< cloud units to the farthest position averaged, strays left out; on request
    std::uint32_t firstVote = 0, votes = 0;
};

/// What is averaged, and how.
struct AverageRules {
    Attributes attributes;
    bool oriented = true;    ///< the sign of normals means something; else n and -n are the same
    bool sides = true;       ///< what is added knows its side, or need not; else its normals are left out
    bool reach = false;      ///< fill Average::reach
    glm::dvec3 gridStep{1};  ///< cloud units
};

/// Averages in Morton order of their cells.
struct AverageList {
    int cellLevel = 0;
    std::vector<Average> averages;
    std::vector<Vote> votes;  ///< empty when the scan is not classified
};

/// Adds the averages of points in Morton order, with the words that stand beside them, where there are any; `list.cellLevel` must not
/// be below the order's resolution.
void appendCells(std::span<const BuildPoint> points, std::span<const BesideWord> beside,
                 const AverageRules& rules, AverageList& list);
/// Adds a list of a finer or equal cell level.
void appendCells(const AverageList& finer, const AverageRules& rules, AverageList& list);
/// Merges runs that appendCells added one after the other (`starts` are their first indices) into one list.
AverageList merge(const AverageList& runs, std::span<const std::size_t> starts, const AverageRules& rules);

/// What most of its points are: the first of Bulk's among equals.
Bulk bulkOf(const Average& average);
/// Mean position in grid steps, relative to a position below all of it.
glm::dvec3 meanPosition(const Average& average, const GridPosition& from);
/// Everything of the sample but its position, rounded to nearest; the classification is the majority's, the
/// smallest among equals.
Sample meanAttributes(const Average& average, const AverageList& list);
std::uint8_t meanNearInfrared(const Average& average);

}  // namespace scancast
