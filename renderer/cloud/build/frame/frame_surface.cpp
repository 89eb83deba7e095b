#include "renderer/cloud/build/frame/frame_surface.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <span>

namespace scancast {

namespace {

/// Points in a cell, on average: the 27 cells around a point of a surface then hold some thirty.
constexpr double pointsPerCell = 2.5;
/// So many make a neighbourhood; fewer, and the cells are made twice as large.
constexpr float fewestAround = 9;
constexpr int coarserLevels = 4;
/// As in the octree's surfels: a longer one is a line of points.
constexpr double leastFlatness = 1.0 / 16;
constexpr std::size_t cellsPerTask = 1024;

/// Of points in units of a cell, about its middle: numbers near 1, for which single precision will do.
struct Moments {
    float count = 0;
    glm::vec3 sum{0};
    glm::vec3 squares{0};   ///< xx yy zz
    glm::vec3 products{0};  ///< xy xz yz

    void add(const glm::vec3& p) {
        count += 1;
        sum += p;
        squares += p * p;
        products += glm::vec3(p.x * p.y, p.x * p.z, p.y * p.z);
    }
    /// Those of another cell, `scale` times as large, whose middle is at `from`.
    void add(const Moments& o, float scale, const glm::vec3& from) {
        const glm::vec3 s = o.sum * scale, f = from * o.count;
        const float square = scale * scale;
        count += o.count;
        sum += s + f;
        squares += square * o.squares + from * (2.0F * s + f);
        products += square * o.products + glm::vec3(s.x * from.y, s.x * from.z, s.y * from.z) +
                    glm::vec3(from.x * s.y, from.x * s.z, from.y * s.z) +
                    glm::vec3(f.x * from.y, f.x * from.z, f.y * from.z);
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
    const double n = double(m.count);
    const glm::dvec3 mean = glm::dvec3(m.sum) / n;
    const glm::dvec3 own = glm::dvec3(m.squares) / n - mean * mean;
    const double xx = own.x, yy = own.y, zz = own.z, xy = double(m.products.x) / n - mean.x * mean.y,
                 xz = double(m.products.y) / n - mean.x * mean.z,
                 yz = double(m.products.z) / n - mean.y * mean.z;
    const double third = (xx + yy + zz) / 3;
    const double spread = std::sqrt(((xx - third) * (xx - third) + (yy - third) * (yy - third) +
                                     (zz - third) * (zz - third) + 2 * (xy * xy + xz * xz + yz * yz)) /
                                    6);
    if (!(spread > 1e-12)) return plane;
    const auto minus = [&](double value) {
        return glm::dmat3(xx - value, xy, xz, xy, yy - value, yz, xz, yz, zz - value);
    };
    const double half =
        std::clamp(glm::determinant(minus(third)) / (spread * spread * spread) / 2, -1.0, 1.0);
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

/// The occupied cells of one size. They are found by the cells of twice the size that hold them: of a cell's 27
/// neighbours, itself included, those of eight.
class CellGrid {
  public:
    int level = 0;
    std::vector<std::uint64_t> keys;  ///< ascending
    std::vector<Moments> moments;

    /// Once all cells are there.
    void index() {
        for (std::size_t c = 0; c < keys.size(); ++c) {
            if (c == 0 || keys[c] >> 3 != keys[c - 1] >> 3)
                families_.push_back({.key = keys[c] >> 3, .first = std::uint32_t(c)});
            families_.back().members = std::uint8_t(families_.back().members | 1u << (keys[c] & 7));
        }
        std::size_t slots = 16;
        while (slots < 2 * families_.size()) slots *= 2;
        mask_ = slots - 1;
        slots_.assign(slots, 0);
        for (std::size_t f = 0; f < families_.size(); ++f) {
            std::size_t at = slotOf(families_[f].key);
            while (slots_[at] != 0) at = (at + 1) & mask_;
            slots_[at] = std::uint32_t(f + 1);
        }
    }
    /// The 3 × 3 × 3 cells around this one, about its middle.
    Moments around(std::uint64_t key) const {
        Moments all;
        const auto cell = cellOfKey(key);
        const std::uint32_t end = 1u << (FrameOrder::bits - level);
        // An odd cell has its family and the next one around it, an even one the one before and its own.
        std::array<std::uint32_t, 3> first{};
        for (std::size_t a = 0; a < 3; ++a) first[a] = cell[a] / 2 + (cell[a] & 1) - 1;  // wraps below 0
        for (std::uint32_t family = 0; family < 8; ++family) {
            const std::array<std::uint32_t, 3> at{first[0] + (family & 1), first[1] + (family >> 1 & 1),
                                                  first[2] + (family >> 2)};
            if (at[0] >= end || at[1] >= end || at[2] >= end) continue;
            if (const Family* found = find(frameKey(at))) addNear(*found, at, cell, all);
        }
        return all;
    }

  private:
    /// The cells of one cell of twice the size, side by side in `keys`.
    struct Family {
        std::uint64_t key = 0;
        std::uint32_t first = 0;
        std::uint8_t members = 0;
    };

    void addNear(const Family& family, const std::array<std::uint32_t, 3>& at,
                 const std::array<std::uint32_t, 3>& cell, Moments& all) const {
        std::uint32_t member = family.first;
        for (unsigned child = 0; child < 8; ++child) {
            if ((family.members >> child & 1) == 0) continue;
            const Moments& there = moments[member++];
            const glm::ivec3 from(int(2 * at[0] + (child & 1) - cell[0]),
                                  int(2 * at[1] + (child >> 1 & 1) - cell[1]),
                                  int(2 * at[2] + (child >> 2) - cell[2]));
            if (std::abs(from.x) <= 1 && std::abs(from.y) <= 1 && std::abs(from.z) <= 1)
                all.add(there, 1, glm::vec3(from));
        }
    }
    std::size_t slotOf(std::uint64_t key) const {
        return std::size_t((key * 0x9e3779b97f4a7c15ull) >> 20) & mask_;
    }
    const Family* find(std::uint64_t key) const {
        for (std::size_t at = slotOf(key); slots_[at] != 0; at = (at + 1) & mask_)
            if (families_[slots_[at] - 1].key == key) return &families_[slots_[at] - 1];
        return nullptr;
    }

    std::vector<Family> families_;
    std::size_t mask_ = 0;
    std::vector<std::uint32_t> slots_;  ///< number of a family, and one; 0 = none
};

/// The finest cells in which there are enough points on average.
int chooseLevel(const FrameOrder& order) {
    const auto counts = order.cellCounts(0, order.size());
    int level = 0;
    while (level +
           coarserLevels<FrameOrder::bits&& double(counts[std::size_t(level)]) * pointsPerCell> double(
               order.size()))
        ++level;
    return level;
}

glm::dvec3 middleOf(std::uint64_t key) {
    const auto cell = cellOfKey(key);
    return glm::dvec3(cell[0], cell[1], cell[2]) + 0.5;
}

CellGrid finestGrid(const FrameOrder& order, std::vector<std::uint32_t>& begin) {
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
    const double size = order.step * std::ldexp(1.0, grid.level);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grid.keys.size(), cellsPerTask),
                      [&](const auto& range) {
                          for (std::size_t c = range.begin(); c != range.end(); ++c) {
                              const glm::dvec3 middle = order.low + middleOf(grid.keys[c]) * size;
                              for (std::uint32_t i = begin[c]; i < begin[c + 1]; ++i)
                                  grid.moments[c].add(glm::vec3((order.points[i].position - middle) / size));
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
        grid.moments.back().add(finer.moments[c], 0.5F,
                                glm::vec3(middleOf(finer.keys[c]) * 0.5 - middleOf(key)));
    }
    grid.index();
    return grid;
}

/// Pitch of a square grid of so many points on such a surface: a square's variance is a twelfth of its area.
double pitchOf(const Moments& around, const FittedPlane& plane) {
    const double area = 12 * std::sqrt(plane.variance[0] * plane.variance[1]);
    return std::sqrt(area / double(around.count));
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
    return std::size_t(std::upper_bound(cellBegin.begin(), cellBegin.end(), std::uint32_t(at)) -
                       cellBegin.begin()) -
           1;
}

FrameSurface estimateFrameSurface(const FrameOrder& order, const std::optional<glm::dvec3>& scanner) {
    FrameSurface surface;
    std::vector<CellGrid> grids;
    grids.push_back(finestGrid(order, surface.cellBegin));
    for (int g = 0; g < coarserLevels; ++g) grids.push_back(coarserGrid(grids.back()));
    const CellGrid& finest = grids.front();
    surface.cells.resize(finest.keys.size());
    const double size = order.step * std::ldexp(1.0, finest.level);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, surface.cells.size(), cellsPerTask), [&](const auto& range) {
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
