#include "renderer/cloud/surfels/spatial_sort.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <glm/common.hpp>

#include <algorithm>
#include <bit>
#include <tuple>

namespace scancast {

namespace {

constexpr std::size_t leafSize = 8, groupSize = 16;
constexpr std::size_t taskSize = 16384;
constexpr double cells = 2097151;  // 2^21 - 1 an axis

struct Keyed {
    std::uint64_t key;
    std::uint32_t point;
};

/// Two zero bits before each of 21 bits.
constexpr std::uint64_t spread(std::uint64_t v) {
    v = (v | v << 32) & 0x001f00000000ffffull;
    v = (v | v << 16) & 0x001f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    v = (v | v << 2) & 0x1249249249249249ull;
    return v;
}

class Cutter {
  public:
    explicit Cutter(std::span<const glm::vec3> points) : points_(points) {}

    /// Gives the range keys relative to its own box and sorts by them. False where all positions are equal.
    bool sort(std::span<Keyed> range) const {
        glm::dvec3 low(at(range.front())), high(low);
        for (const Keyed& k : range) {
            low = glm::min(low, glm::dvec3(at(k)));
            high = glm::max(high, glm::dvec3(at(k)));
        }
        const glm::dvec3 size = high - low;
        const double extent = std::max({size.x, size.y, size.z});
        if (!(extent > 0)) return false;
        const double scale = cells / extent;
        for (Keyed& k : range) {
            const glm::dvec3 c = (glm::dvec3(at(k)) - low) * scale;
            k.key = spread(std::uint64_t(c.x)) | spread(std::uint64_t(c.y)) << 1 |
                    spread(std::uint64_t(c.z)) << 2;
        }
        const auto byKey = [](const Keyed& a, const Keyed& b) { return a.key < b.key; };
        if (range.size() > taskSize)
            tbb::parallel_sort(range.begin(), range.end(), byKey);
        else
            std::sort(range.begin(), range.end(), byKey);
        return true;
    }

    /// Where a sorted range with more than one key falls into halves.
    static std::size_t middle(std::span<const Keyed> range) {
        const std::uint64_t highest = std::bit_floor(range.front().key ^ range.back().key);
        return std::size_t(std::partition_point(range.begin(), range.end(),
                                                [&](const Keyed& k) { return (k.key & highest) == 0; }) -
                           range.begin());
    }

    glm::vec3 at(const Keyed& k) const { return points_[k.point]; }

  private:
    std::span<const glm::vec3> points_;
};

/// What one task finds in its part of the order.
class Part {
  public:
    Part(const Cutter& cutter, std::span<Keyed> all, std::size_t begin, std::size_t end)
        : cutter_(cutter), all_(all) {
        split(begin, end, false);
    }

    std::vector<std::uint32_t> firstOf;            ///< in the whole order
    std::vector<std::uint32_t> leafEnd, groupEnd;  ///< in positions of this part

  private:
    void split(std::size_t begin, std::size_t end, bool inGroup) {
        const bool opensGroup = !inGroup && end - begin <= groupSize;
        if (end - begin <= leafSize) {
            leaf(begin, end);
        } else if (all_[begin].key == all_[end - 1].key) {
            if (cutter_.sort(all_.subspan(begin, end - begin)))
                halve(begin, end, inGroup || opensGroup);
            else
                single(begin, !inGroup && !opensGroup);
        } else {
            halve(begin, end, inGroup || opensGroup);
        }
        if (opensGroup) groupEnd.push_back(std::uint32_t(firstOf.size()));
    }

    void halve(std::size_t begin, std::size_t end, bool inGroup) {
        const std::size_t middle = begin + Cutter::middle(all_.subspan(begin, end - begin));
        split(begin, middle, inGroup);
        split(middle, end, inGroup);
    }

    /// A crowd of equal points is one position.
    void single(std::size_t begin, bool ownGroup) {
        firstOf.push_back(std::uint32_t(begin));
        leafEnd.push_back(std::uint32_t(firstOf.size()));
        if (ownGroup) groupEnd.push_back(std::uint32_t(firstOf.size()));
    }

    void leaf(std::size_t begin, std::size_t end) {
        const auto place = [&](const Keyed& k) {
            const glm::vec3 p = cutter_.at(k);
            return std::tuple(p.x, p.y, p.z);
        };
        std::sort(all_.begin() + std::ptrdiff_t(begin), all_.begin() + std::ptrdiff_t(end),
                  [&](const Keyed& a, const Keyed& b) { return place(a) < place(b); });
        for (std::size_t i = begin; i < end; ++i)
            if (i == begin || cutter_.at(all_[i - 1]) != cutter_.at(all_[i]))
                firstOf.push_back(std::uint32_t(i));
        leafEnd.push_back(std::uint32_t(firstOf.size()));
    }

    const Cutter& cutter_;
    std::span<Keyed> all_;
};

/// Parts of a sorted range that tasks can take, along the cells' borders.
void cutTasks(std::span<const Keyed> all, std::size_t begin, std::size_t end,
              std::vector<std::size_t>& ends) {
    if (end - begin <= taskSize || all[begin].key == all[end - 1].key) {
        ends.push_back(end);
        return;
    }
    const std::size_t middle = begin + Cutter::middle(all.subspan(begin, end - begin));
    cutTasks(all, begin, middle, ends);
    cutTasks(all, middle, end, ends);
}

void join(std::vector<Part>& parts, std::size_t points, SpatialOrder& out) {
    std::uint32_t before = 0;
    out.leafBegin.push_back(0);
    out.groupBegin.push_back(0);
    for (const Part& p : parts) {
        out.firstOf.insert(out.firstOf.end(), p.firstOf.begin(), p.firstOf.end());
        for (const std::uint32_t e : p.leafEnd) out.leafBegin.push_back(before + e);
        for (const std::uint32_t e : p.groupEnd) out.groupBegin.push_back(before + e);
        before += std::uint32_t(p.firstOf.size());
    }
    out.firstOf.push_back(std::uint32_t(points));
}

}  // namespace

SpatialOrder spatialOrder(std::span<const glm::vec3> points) {
    std::vector<Keyed> all(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) all[i] = {0, std::uint32_t(i)};
    const Cutter cutter(points);
    cutter.sort(all);
    std::vector<std::size_t> ends;
    cutTasks(all, 0, all.size(), ends);
    std::vector<std::vector<Part>> found(ends.size());
    tbb::parallel_for(std::size_t(0), ends.size(), [&](std::size_t t) {
        found[t].emplace_back(cutter, all, t == 0 ? 0 : ends[t - 1], ends[t]);
    });
    std::vector<Part> parts;
    for (auto& f : found) parts.push_back(std::move(f.front()));
    SpatialOrder out;
    join(parts, points.size(), out);
    out.order.resize(points.size());
    for (std::size_t i = 0; i < all.size(); ++i) out.order[i] = all[i].point;
    return out;
}

}  // namespace scancast
