#include "renderer/cloud/build/frame/frame_surface.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

namespace scancast {

namespace {

/// Points in a cell, on average: the 27 cells around a point of a surface then hold some thirty.
constexpr double pointsPerCell = 2.5;
/// So many make a neighbourhood; fewer, and the cells are made twice as large.
constexpr double fewestAround = 9;
constexpr int coarserLevels = 4;
/// As in the octree's surfels: a longer one is a line of points.
constexpr double leastFlatness = 1.0 / 16;
constexpr std::size_t cellsPerTask = 1024;

/// Of points in units of a cell, about its middle.
struct Moments {
    double count = 0;
    glm::dvec3 sum{0};
    std::array<double, 6> products{};  ///< xx yy zz xy xz yz

    void add(const glm::dvec3& p) {
        count += 1;
        sum += p;
        const std::array<double, 6> q{p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.x * p.z, p.y * p.z};
        for (std::size_t i = 0; i < q.size(); ++i) products[i] += q[i];
    }
    /// Those of another cell, `scale` times as large, whose middle is at `from`.
    void add(const Moments& o, double scale, const glm::dvec3& from) {
        const glm::dvec3 s = o.sum * scale;
        const glm::dvec3 f = from;
        const double n = o.count, square = scale * scale;
        count += n;
        sum += s + n * f;
        const auto& q = o.products;
        products[0] += square * q[0] + 2 * s.x * f.x + n * f.x * f.x;
        products[1] += square * q[1] + 2 * s.y * f.y + n * f.y * f.y;
        products[2] += square * q[2] + 2 * s.z * f.z + n * f.z * f.z;
        products[3] += square * q[3] + s.x * f.y + s.y * f.x + n * f.x * f.y;
        products[4] += square * q[4] + s.x * f.z + s.z * f.x + n * f.x * f.z;
        products[5] += square * q[5] + s.y * f.z + s.z * f.y + n * f.y * f.z;
    }
};

/// The plane through a neighbourhood: variances along and across it, in squares of a cell.
struct FittedPlane {
    glm::dvec3 normal{0};
    std::array<double, 3> variance{};  ///< descending
};

/// In closed form: after Smith, "Eigenvalues of a symmetric 3 × 3 matrix", 1961.
FittedPlane planeOf(const Moments& m) {
    FittedPlane plane;
    if (m.count < 3) return plane;
    const glm::dvec3 mean = m.sum / m.count;
    const double xx = m.products[0] / m.count - mean.x * mean.x, yy = m.products[1] / m.count - mean.y * mean.y,
                 zz = m.products[2] / m.count - mean.z * mean.z, xy = m.products[3] / m.count - mean.x * mean.y,
                 xz = m.products[4] / m.count - mean.x * mean.z, yz = m.products[5] / m.count - mean.y * mean.z;
    const double third = (xx + yy + zz) / 3;
    const double spread = std::sqrt(((xx - third) * (xx - third) + (yy - third) * (yy - third) + (zz - third) * (zz - third) +
                                     2 * (xy * xy + xz * xz + yz * yz)) /
                                    6);
    if (!(spread > 1e-12)) return plane;
    const auto minus = [&](double value) { return glm::dmat3(xx - value, xy, xz, xy, yy - value, yz, xz, yz, zz - value); };
    const double half = std::clamp(glm::determinant(minus(third)) / (spread * spread * spread) / 2, -1.0, 1.0);
    const double angle = std::acos(half) / 3;
    const double most = third + 2 * spread * std::cos(angle);
    const double least = third + 2 * spread * std::cos(angle + 2 * std::numbers::pi / 3);
    plane.variance = {most, std::max(3 * third - most - least, 0.0), std::max(least, 0.0)};
    // Every column of this product is a multiple of the direction across; the longest is the surest.
    const glm::dmat3 across = minus(most) * minus(plane.variance[1]);
    glm::dvec3 longest = across[0];
    for (int c = 1; c < 3; ++c)
        if (glm::dot(across[c], across[c]) > glm::dot(longest, longest)) longest = across[c];
    const double length = glm::length(longest);
    if (length > 1e-15) plane.normal = longest / length;
    return plane;
}

/// The occupied cells of one size, found by their keys.
class CellGrid {
  public:
    int level = 0;
    std::vector<std::uint64_t> keys;  ///< ascending
    std::vector<Moments> moments;

    void index() {
        std::size_t slots = 16;
        while (slots < 2 * keys.size()) slots *= 2;
        mask_ = slots - 1;
        slots_.assign(slots, 0);
        for (std::size_t c = 0; c < keys.size(); ++c) {
            std::size_t at = slotOf(keys[c]);
            while (slots_[at] != 0) at = (at + 1) & mask_;
            slots_[at] = std::uint32_t(c + 1);
        }
    }
    /// The 3 × 3 × 3 cells around this one, about its middle.
    Moments around(std::uint64_t key) const {
        Moments all;
        const auto cell = cellOfKey(key);
        const std::uint32_t end = 1u << (FrameOrder::bits - level);
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x) {
                    // Below 0 wraps to far above the end.
                    const std::array<std::uint32_t, 3> at{cell[0] + std::uint32_t(x), cell[1] + std::uint32_t(y),
                                                          cell[2] + std::uint32_t(z)};
                    if (at[0] >= end || at[1] >= end || at[2] >= end) continue;
                    if (const Moments* there = find(frameKey(at))) all.add(*there, 1, {x, y, z});
                }
        return all;
    }

  private:
    std::size_t slotOf(std::uint64_t key) const { return std::size_t((key * 0x9e3779b97f4a7c15ull) >> 20) & mask_; }
    const Moments* find(std::uint64_t key) const {
        for (std::size_t at = slotOf(key); slots_[at] != 0; at = (at + 1) & mask_)
            if (keys[slots_[at] - 1] == key) return &moments[slots_[at] - 1];
        return nullptr;
    }

    std::size_t mask_ = 0;
    std::vector<std::uint32_t> slots_;  ///< number of a cell, and one; 0 = none
};

/// The finest cells in which there are enough points on average.
int chooseLevel(const FrameOrder& order) {
    const auto counts = order.cellCounts(0, order.size());
    int level = 0;
    while (level + coarserLevels < FrameOrder::bits &&
           double(counts[std::size_t(level)]) * pointsPerCell > double(order.size()))
        ++level;
    return level;
}

glm::dvec3 middleOf(std::uint64_t key) {
    const auto cell = cellOfKey(key);
    return glm::dvec3(cell[0], cell[1], cell[2]) + 0.5;
}

CellGrid finestGrid(std::span<const glm::dvec3> positions, const FrameOrder& order,
                    std::vector<std::uint32_t>& begin) {
    CellGrid grid;
    grid.level = chooseLevel(order);
    const int shift = 3 * grid.level;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && order.keys[i - 1] >> shift == order.keys[i] >> shift) continue;
        grid.keys.push_back(order.keys[i] >> shift);
        begin.push_back(std::uint32_t(i));
    }
    begin.push_back(std::uint32_t(order.size()));
    grid.moments.resize(grid.keys.size());
    const double perCell = std::ldexp(1.0, -grid.level);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grid.keys.size(), cellsPerTask), [&](const auto& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            const glm::dvec3 middle = middleOf(grid.keys[c]);
            for (std::uint32_t i = begin[c]; i < begin[c + 1]; ++i)
                grid.moments[c].add(order.inCells(positions[order.order[i]]) * perCell - middle);
        }
    });
    grid.index();
    return grid;
}

/// Cells twice as large.
CellGrid coarserGrid(const CellGrid& finer) {
    CellGrid grid;
    grid.level = finer.level + 1;
    for (std::size_t c = 0; c < finer.keys.size(); ++c) {
        const std::uint64_t key = finer.keys[c] >> 3;
        if (grid.keys.empty() || grid.keys.back() != key) {
            grid.keys.push_back(key);
            grid.moments.emplace_back();
        }
        grid.moments.back().add(finer.moments[c], 0.5, middleOf(finer.keys[c]) * 0.5 - middleOf(key));
    }
    grid.index();
    return grid;
}

/// Pitch of a square grid of so many points on such a surface: a square's variance is a twelfth of its area.
double pitchOf(const Moments& around, const FittedPlane& plane) {
    const double area = 12 * std::sqrt(plane.variance[0] * plane.variance[1]);
    return std::sqrt(area / around.count);
}

/// In the finest cells around which there are enough points that are no line.
CellSurface surfaceOf(std::uint64_t key, std::span<const CellGrid> grids, double step) {
    CellSurface surface;
    for (std::size_t g = 0; g < grids.size(); ++g) {
        const CellGrid& grid = grids[g];
        const Moments around = grid.around(key >> (3 * g));
        const bool last = g + 1 == grids.size();
        if (around.count < fewestAround && !last) continue;
        const FittedPlane plane = planeOf(around);
        const bool flat = plane.variance[1] > leastFlatness * plane.variance[0];
        if (!flat && !last) continue;
        if (flat) {
            surface.normal = glm::vec3(plane.normal);
            surface.spacing = float(pitchOf(around, plane) * step * std::ldexp(1.0, grid.level));
        }
        break;
    }
    // Nothing is known of it: as small as what is dense, because only evidence of a surface makes things large.
    if (!(surface.spacing > 0)) surface.spacing = float(step * std::ldexp(1.0, grids[0].level));
    surface.spacing = std::max(surface.spacing, float(step));
    return surface;
}

}  // namespace

std::size_t FrameSurface::cellAt(std::size_t at) const {
    return std::size_t(std::upper_bound(cellBegin.begin(), cellBegin.end(), std::uint32_t(at)) - cellBegin.begin()) -
           1;
}

FrameSurface estimateFrameSurface(std::span<const glm::dvec3> positions, const FrameOrder& order,
                                  const std::optional<glm::dvec3>& scanner) {
    FrameSurface surface;
    std::vector<CellGrid> grids;
    grids.push_back(finestGrid(positions, order, surface.cellBegin));
    for (int g = 0; g < coarserLevels; ++g) grids.push_back(coarserGrid(grids.back()));
    const CellGrid& finest = grids.front();
    surface.cells.resize(finest.keys.size());
    const double size = order.step * std::ldexp(1.0, finest.level);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surface.cells.size(), cellsPerTask), [&](const auto& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            CellSurface& cell = surface.cells[c];
            cell = surfaceOf(finest.keys[c], grids, order.step);
            if (!scanner) continue;
            const glm::dvec3 sight = *scanner - (order.low + middleOf(finest.keys[c]) * size);
            if (glm::dot(glm::dvec3(cell.normal), sight) < 0) cell.normal = -cell.normal;
        }
    });
    return surface;
}

}  // namespace scancast
