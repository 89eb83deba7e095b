#include "renderer/cloud/build/frame/frame_order.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

namespace scancast {

namespace {

struct KeyedPoint {
    std::uint64_t key;
    std::uint32_t point;
    bool operator<(const KeyedPoint& o) const { return key != o.key ? key < o.key : point < o.point; }
};

constexpr std::size_t pointsPerTask = 16384;
/// Of the keys' highest bits: enough that what has the same ones fits a core's cache.
constexpr int bucketBits = 12;

template <class F>
void inFrame(std::size_t count, const F& f) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, pointsPerTask), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) f(i);
    });
}

FramePoint framePoint(const PointBatch& points, std::size_t i, const glm::dvec3& origin) {
    FramePoint point{.position = points.position[i] - origin};
    if (!points.color.empty()) point.color = points.color[i];
    if (!points.intensity.empty()) point.intensity = points.intensity[i];
    if (!points.classification.empty()) point.classification = points.classification[i];
    if (!points.normal.empty() && points.normal[i] != glm::vec3(0))
        point.normal = encodeNormal(points.normal[i]);
    return point;
}

/// Two zero bits before each of 21 bits.
constexpr std::uint64_t spreadCell(std::uint64_t v) {
    v = (v | v << 32) & 0x001f00000000ffffull;
    v = (v | v << 16) & 0x001f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    v = (v | v << 2) & 0x1249249249249249ull;
    return v;
}

constexpr std::uint32_t gatherCell(std::uint64_t v) {
    v &= 0x1249249249249249ull;
    v = (v | v >> 2) & 0x10c30c30c30c30c3ull;
    v = (v | v >> 4) & 0x100f00f00f00f00full;
    v = (v | v >> 8) & 0x001f0000ff0000ffull;
    v = (v | v >> 16) & 0x001f00000000ffffull;
    v = (v | v >> 32) & 0x00000000001fffffull;
    return std::uint32_t(v);
}

/// By their highest bits first, then each bucket by itself.
std::vector<KeyedPoint> sortedByKey(const std::vector<KeyedPoint>& points) {
    constexpr int shift = 3 * FrameOrder::bits - bucketBits;
    std::vector<std::uint32_t> begin((1u << bucketBits) + 1);
    for (const KeyedPoint& p : points) ++begin[(p.key >> shift) + 1];
    for (std::size_t b = 1; b < begin.size(); ++b) begin[b] += begin[b - 1];
    std::vector<KeyedPoint> sorted(points.size());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (const KeyedPoint& p : points) sorted[next[p.key >> shift]++] = p;
    tbb::parallel_for(std::size_t(0), next.size(), [&](std::size_t b) {
        const auto first = sorted.begin() + begin[b], last = sorted.begin() + begin[b + 1];
        if (last - first > std::ptrdiff_t(pointsPerTask))
            tbb::parallel_sort(first, last);
        else
            std::sort(first, last);
    });
    return sorted;
}

}  // namespace

std::uint64_t frameKey(const std::array<std::uint32_t, 3>& cell) {
    return spreadCell(cell[0]) | spreadCell(cell[1]) << 1 | spreadCell(cell[2]) << 2;
}

std::array<std::uint32_t, 3> cellOfKey(std::uint64_t key) {
    return {gatherCell(key), gatherCell(key >> 1), gatherCell(key >> 2)};
}

std::array<std::uint32_t, FrameOrder::bits + 1> FrameOrder::cellCounts(std::size_t begin,
                                                                       std::size_t end) const {
    std::array<std::uint32_t, bits + 1> steps{}, counts{};
    for (std::size_t i = begin + 1; i < end; ++i) ++steps[std::size_t(commonLevel(keys[i - 1], keys[i]))];
    std::uint32_t cells =
        1;  // a cell of level n ends where its next point is in common at a higher level only
    for (int level = bits; level >= 0; --level) {
        counts[std::size_t(level)] = cells;
        cells += steps[std::size_t(level)];
    }
    return counts;
}

FrameOrder orderFrame(const PointBatch& points, const std::array<glm::dvec3, 2>& bounds,
                      const glm::dvec3& origin) {
    FrameOrder frame;
    frame.low = bounds[0] - origin;
    const glm::dvec3 size = bounds[1] - bounds[0];
    const double extent = std::max({size.x, size.y, size.z});
    constexpr double cells = double((1u << FrameOrder::bits) - 1);
    // All at one place: any step will do.
    frame.step = extent > 1e-25 ? extent / cells : 1e-6;
    std::vector<KeyedPoint> keyed(points.size());
    const double perStep = 1 / frame.step;
    inFrame(points.size(), [&](std::size_t i) {
        std::array<std::uint32_t, 3> cell{};
        const glm::dvec3 at = (points.position[i] - bounds[0]) * perStep;
        for (int a = 0; a < 3; ++a) cell[std::size_t(a)] = std::uint32_t(std::clamp(at[a], 0.0, cells));
        keyed[i] = {frameKey(cell), std::uint32_t(i)};
    });
    keyed = sortedByKey(keyed);
    frame.keys.resize(keyed.size());
    frame.points.resize(keyed.size());
    inFrame(keyed.size(), [&](std::size_t i) {
        frame.keys[i] = keyed[i].key;
        frame.points[i] = framePoint(points, keyed[i].point, origin);
    });
    return frame;
}

}  // namespace scancast
