// Points in a balanced k-d tree, each part with its box, for exact nearest-point queries. Immutable once built; *thread safety*: any
// number of threads. Pipeline: a node's points → **tree** → distances.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "renderer/cloud/distance/box.hpp"

namespace scancast {

class PointTree {
  public:
    /// At least one point, all finite. The tree depends on the points and their order alone.
    explicit PointTree(std::span<const glm::dvec3> points);

    struct Nearest {
        double squared =
            std::numeric_limits<double>::infinity();  ///< only points nearer than that are looked for
        std::uint32_t place = 0;                      ///< in this tree; means nothing before one was found
    };
    /// The nearest point to `p`, if it is nearer than `nearest` says; whether there is one. Of points equally near, one, and always
    /// the same.
    bool findNearer(const glm::dvec3& p, Nearest& nearest) const;

    /// Of all points that are the nearest to `p`, the first one that it was made of: its index().
    std::uint32_t firstNearest(const glm::dvec3& p, Nearest nearest) const;

    glm::dvec3 point(std::uint32_t place) const { return {x_[place], y_[place], z_[place]}; }
    /// Which of the points that it was made of stands there.
    std::uint32_t index(std::uint32_t place) const { return index_[place]; }
    const DistanceBox& box() const { return boxes_.front(); }
    std::uint64_t bytes() const;

  private:
    std::size_t buckets() const { return std::size_t(1) << levels_; }
    /// First point of a bucket; of the one behind the last, how many points there are.
    std::size_t first(std::size_t bucket) const { return x_.size() * bucket >> levels_; }
    void scan(std::size_t bucket, const glm::dvec3& p, Nearest& nearest) const;

    int levels_ = 0;
    /// A complete binary tree: the root, then each level in turn; the last one has the buckets' boxes.
    std::vector<DistanceBox> boxes_;
    std::vector<double> x_, y_, z_;
    std::vector<std::uint32_t> index_;
};

}  // namespace scancast
