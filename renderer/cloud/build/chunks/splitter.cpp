#include "renderer/cloud/build/chunks/splitter.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace scancast {

namespace {

constexpr std::size_t grain = 1 << 16;

__extension__ using Wide = unsigned __int128;  // 42 bits times the number of points

struct Sums {
    GridBox box;
    std::array<Wide, 3> sum{};
};

/// Sum of the offsets from the box and of their squares, in units that make the box 16 bits wide.
struct Spread {
    std::array<std::uint64_t, 3> sum{}, squares{};
};

/// Integer reduction: the same for any division of the range.
template <class T, class Add, class Join>
T reduce(std::span<const BuildPoint> points, Add add, Join join) {
    const auto run = [&](const tbb::blocked_range<std::size_t>& range, T value) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) add(value, points[i]);
        return value;
    };
    if (points.size() < 4 * grain) return run({0, points.size()}, T{});
    return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, points.size(), grain), T{}, run, join);
}

Spread measureSpread(std::span<const BuildPoint> points, const GridBox& box,
                     const std::array<int, 3>& shift) {
    return reduce<Spread>(
        points,
        [&](Spread& s, const BuildPoint& p) {
            for (int a = 0; a < 3; ++a) {
                const std::uint64_t offset = (p.axis(a) - box.min[a]) >> shift[a];
                s.sum[a] += offset;
                s.squares[a] += offset * offset;
            }
        },
        [](Spread s, const Spread& t) {
            for (int a = 0; a < 3; ++a) {
                s.sum[a] += t.sum[a];
                s.squares[a] += t.squares[a];
            }
            return s;
        });
}

/// Which axes to split: those along which the standard deviation is at least a quarter of the largest.
std::array<bool, 3> axesToSplit(std::span<const BuildPoint> points, const GridBox& box, const Grid& grid) {
    std::array<int, 3> shift;
    for (int a = 0; a < 3; ++a) shift[a] = std::max(0, int(std::bit_width(box.max[a] - box.min[a])) - 16);
    const Spread spread = measureSpread(points, box, shift);
    const double n = double(points.size());
    std::array<double, 3> variance;
    for (int a = 0; a < 3; ++a) {
        const double mean = double(spread.sum[a]) / n;
        const double unit = grid.step[a] * double(std::uint64_t(1) << shift[a]);
        variance[a] = std::max(0.0, double(spread.squares[a]) / n - mean * mean) * unit * unit;
    }
    const double widest = *std::max_element(variance.begin(), variance.end());
    std::array<bool, 3> axes;
    for (int a = 0; a < 3; ++a) axes[a] = box.max[a] > box.min[a] && variance[a] * 16 >= widest;
    return axes;
}

struct Cut {
    std::array<bool, 3> axes;
    GridPosition at;
    unsigned octant(const BuildPoint& p) const {
        unsigned o = 0;
        for (int a = 0; a < 3; ++a) o |= unsigned(axes[a] && p.axis(a) > at[a]) << a;
        return o;
    }
};

}  // namespace

Measure measure(std::span<const BuildPoint> points) {
    const Sums sums = reduce<Sums>(
        points,
        [](Sums& s, const BuildPoint& p) {
            const GridPosition q = p.position();
            s.box.add(q);
            for (int a = 0; a < 3; ++a) s.sum[a] += q[a];
        },
        [](Sums s, const Sums& t) {
            s.box.add(t.box);
            for (int a = 0; a < 3; ++a) s.sum[a] += t.sum[a];
            return s;
        });
    Measure m;
    m.box = sums.box;
    for (int a = 0; a < 3; ++a) m.average[a] = std::uint64_t(sums.sum[a] / points.size());
    return m;
}

Octants split(std::span<BuildPoint> points, const Measure& measure, const Grid& grid, int level) {
    Cut cut{axesToSplit(points, measure.box, grid), measure.average};
    if (level >= lastAverageLevel)
        for (int a = 0; a < 3; ++a)
            cut.at[a] = measure.box.min[a] + (measure.box.max[a] - measure.box.min[a]) / 2;

    using Counts = std::array<std::size_t, 8>;
    const Counts counts = reduce<Counts>(
        points, [&](Counts& c, const BuildPoint& p) { ++c[cut.octant(p)]; },
        [](Counts c, const Counts& d) {
            for (int o = 0; o < 8; ++o) c[o] += d[o];
            return c;
        });
    Octants octants;
    for (int o = 0; o < 8; ++o) octants.first[o + 1] = octants.first[o] + counts[o];

    // Each octant's next free place; every exchange brings one point home.
    std::array<std::size_t, 8> next;
    std::copy_n(octants.first.begin(), 8, next.begin());
    for (unsigned o = 0; o < 8; ++o)
        while (next[o] < octants.first[o + 1]) {
            const unsigned home = cut.octant(points[next[o]]);
            if (home == o)
                ++next[o];
            else
                std::swap(points[next[o]], points[next[home]++]);
        }
    return octants;
}

}  // namespace scancast
