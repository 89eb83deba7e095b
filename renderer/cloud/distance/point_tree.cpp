#include "renderer/cloud/distance/point_tree.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace scancast {

namespace {

constexpr std::size_t mostInBucket = 16;

struct Placed {
    glm::dvec3 p;
    std::uint32_t index;
};

int widestAxis(std::span<const Placed> points) {
    DistanceBox box;
    for (const Placed& placed : points) box.add(placed.p);
    const glm::dvec3 size = box.high - box.low;
    int widest = 0;
    for (int a = 1; a < 3; ++a)
        if (size[a] > size[widest]) widest = a;
    return widest;
}

/// Halves `points`, whose first bucket of 2^levels is `bucket`, until each half is one.
struct Halving {
    std::size_t count;  ///< of all points
    int levels;

    std::size_t first(std::size_t bucket) const { return count * bucket >> levels; }
    void halve(std::span<Placed> points, std::size_t bucket, int left) const {
        if (left == 0) {
            std::ranges::sort(points, {}, &Placed::index);
            return;
        }
        const std::size_t middle = bucket + (std::size_t(1) << (left - 1));
        const auto half = std::ptrdiff_t(first(middle) - first(bucket));
        const int axis = widestAxis(points);
        // An order without equals: what stands on each side is decided, whoever sorts.
        std::ranges::nth_element(points, points.begin() + half, [axis](const Placed& a, const Placed& b) {
            return a.p[axis] != b.p[axis] ? a.p[axis] < b.p[axis] : a.index < b.index;
        });
        halve(points.first(std::size_t(half)), bucket, left - 1);
        halve(points.subspan(std::size_t(half)), middle, left - 1);
    }
};

}  // namespace

PointTree::PointTree(std::span<const glm::dvec3> points) {
    while (points.size() > mostInBucket << levels_) ++levels_;
    std::vector<Placed> placed(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) placed[i] = {points[i], std::uint32_t(i)};
    Halving{points.size(), levels_}.halve(placed, 0, levels_);

    x_.reserve(points.size());
    y_.reserve(points.size());
    z_.reserve(points.size());
    index_.reserve(points.size());
    for (const Placed& one : placed) {
        x_.push_back(one.p.x);
        y_.push_back(one.p.y);
        z_.push_back(one.p.z);
        index_.push_back(one.index);
    }
    boxes_.resize(2 * buckets() - 1);
    for (std::size_t bucket = 0; bucket < buckets(); ++bucket)
        for (std::size_t i = first(bucket); i < first(bucket + 1); ++i)
            boxes_[buckets() - 1 + bucket].add(placed[i].p);
    for (std::size_t i = buckets() - 1; i-- > 0;) {
        boxes_[i] = boxes_[2 * i + 1];
        boxes_[i].add(boxes_[2 * i + 2]);
    }
}

std::uint64_t PointTree::bytes() const {
    return sizeof *this + boxes_.size() * sizeof(DistanceBox) +
           x_.size() * (3 * sizeof(double) + sizeof(std::uint32_t));
}

void PointTree::scan(std::size_t bucket, const glm::dvec3& p, Nearest& nearest) const {
    for (std::size_t i = first(bucket); i < first(bucket + 1); ++i) {
        const double squared = squaredLength(glm::dvec3(x_[i], y_[i], z_[i]) - p);
        if (squared >= nearest.squared) continue;
        nearest = {squared, std::uint32_t(i)};
    }
}

bool PointTree::findNearer(const glm::dvec3& p, Nearest& nearest) const {
    struct Open {
        std::size_t part;
        double squared;
    };
    const double before = nearest.squared;
    std::array<Open, 64> open;  // at most one for each level
    std::size_t waiting = 0;
    open[waiting++] = {0, boxes_.front().squaredTo(p)};
    while (waiting > 0) {
        auto [part, squared] = open[--waiting];
        while (squared < nearest.squared) {
            if (part >= buckets() - 1) {
                scan(part - (buckets() - 1), p, nearest);
                break;
            }
            Open near{2 * part + 1, boxes_[2 * part + 1].squaredTo(p)};
            Open far{2 * part + 2, boxes_[2 * part + 2].squaredTo(p)};
            if (far.squared < near.squared) std::swap(near, far);
            if (far.squared < nearest.squared) open[waiting++] = far;
            part = near.part;
            squared = near.squared;
        }
    }
    return nearest.squared < before;
}

std::uint32_t PointTree::firstNearest(const glm::dvec3& p, Nearest nearest) const {
    findNearer(p, nearest);
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
    std::array<std::size_t, 64> open;
    std::size_t waiting = 0;
    open[waiting++] = 0;
    while (waiting > 0) {
        const std::size_t part = open[--waiting];
        if (boxes_[part].squaredTo(p) > nearest.squared) continue;
        if (part < buckets() - 1) {
            open[waiting++] = 2 * part + 2;
            open[waiting++] = 2 * part + 1;
            continue;
        }
        const std::size_t bucket = part - (buckets() - 1);
        for (std::size_t i = this->first(bucket); i < this->first(bucket + 1); ++i)
            if (squaredLength(glm::dvec3(x_[i], y_[i], z_[i]) - p) == nearest.squared)
                first = std::min(first, index_[i]);
    }
    return first;
}

}  // namespace scancast
