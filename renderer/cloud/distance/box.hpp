// A box along the axes, and how far it is from points and other boxes. Plain values.
#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace scancast {

/// Squares of lengths are added x, y, z, here and between points: rounding then never makes a box farther than what is in it.
inline double squaredLength(const glm::dvec3& v) {
    return v.x * v.x + v.y * v.y + v.z * v.z;
}

struct DistanceBox {
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    void add(const DistanceBox& box) {
        low = glm::min(low, box.low);
        high = glm::max(high, box.high);
    }
    /// 0 inside.
    double squaredTo(const glm::dvec3& p) const {
        return squaredLength(glm::max(glm::max(low - p, p - high), glm::dvec3(0)));
    }
    /// 0 where they touch.
    double squaredTo(const DistanceBox& box) const {
        return squaredLength(glm::max(glm::max(low - box.high, box.low - high), glm::dvec3(0)));
    }
};

}  // namespace scancast
