// A tree of boxes around things that a ray may meet, so that it need not try them all. Built once, then read
// by all threads. Made by the surface area heuristic over a few bins; the same boxes give the same tree.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "tests/ground_truth/patch_ray.hpp"

namespace scancast {

class BoxTree {
  public:
    struct Box {
        glm::dvec3 low{1e300}, high{-1e300};

        void include(const Box& other) {
            low = glm::min(low, other.low);
            high = glm::max(high, other.high);
        }
        double halfArea() const {
            const glm::dvec3 size = glm::max(high - low, glm::dvec3(0));
            return size.x * size.y + size.y * size.z + size.z * size.x;
        }
    };

    static BoxTree build(std::span<const Box> boxes);

    /// Calls `visit(item, high)` for the items whose boxes the ray may meet with low < t < high, nearer
    /// branches first; it returns the `high` from then on, smaller when it has found something.
    template <class Visit>
    void walk(const Ray& ray, double low, double high, Visit&& visit) const;

  private:
    struct Node {
        Box box;
        std::uint32_t first = 0;  ///< leaf: into items_; else the second child (the first one follows)
        std::uint32_t count = 0;  ///< 0 = inner node
    };

    void split(std::span<const Box> boxes, std::uint32_t from, std::uint32_t to, int depth);
    static double entry(const Box& box, const glm::dvec3& origin, const glm::dvec3& inverse, double low,
                        double high);

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> items_;
};

/// Where the ray enters the box, or infinity.
inline double BoxTree::entry(const Box& box, const glm::dvec3& origin, const glm::dvec3& inverse, double low,
                             double high) {
    const glm::dvec3 a = (box.low - origin) * inverse, b = (box.high - origin) * inverse;
    const glm::dvec3 near = glm::min(a, b), far = glm::max(a, b);
    const double enter = std::max(std::max(near.x, near.y), std::max(near.z, low));
    const double leave = std::min(std::min(far.x, far.y), std::min(far.z, high));
    return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

template <class Visit>
void BoxTree::walk(const Ray& ray, double low, double high, Visit&& visit) const {
    if (nodes_.empty()) return;
    // Finite, so that a box that is missed - entered at infinity - is always beyond it.
    high = std::min(high, std::numeric_limits<double>::max());
    // A direction of 0 would make 0 · infinity; a tiny one makes the same decision.
    glm::dvec3 inverse;
    for (int axis = 0; axis < 3; ++axis)
        inverse[axis] = 1 / (std::abs(ray.direction[axis]) < 1e-200 ? 1e-200 : ray.direction[axis]);
    struct Pending {
        std::uint32_t node;
        double enter;
    };
    std::array<Pending, 2 * 64> stack;
    std::size_t depth = 0;
    const double first = entry(nodes_[0].box, ray.origin, inverse, low, high);
    if (first <= high) stack[depth++] = {0, first};
    while (depth > 0) {
        const Pending next = stack[--depth];
        if (next.enter > high) continue;
        const Node& node = nodes_[next.node];
        if (node.count > 0) {
            for (std::uint32_t i = 0; i < node.count; ++i) high = visit(items_[node.first + i], high);
            continue;
        }
        Pending left{next.node + 1, 0}, right{node.first, 0};
        left.enter = entry(nodes_[left.node].box, ray.origin, inverse, low, high);
        right.enter = entry(nodes_[right.node].box, ray.origin, inverse, low, high);
        if (left.enter > right.enter) std::swap(left, right);
        if (right.enter <= high) stack[depth++] = right;
        if (left.enter <= high) stack[depth++] = left;
    }
}

}  // namespace scancast
