#include "renderer/select/select.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <numbers>
#include <queue>

namespace scancast {

namespace {

/// The view volume with its sides moved out by some pixels. Planes are cloud-relative with unit normals;
/// inside is dot(n, p) + w ≥ 0.
class GrownFrustum {
  public:
    GrownFrustum(const Viewpoint& v, double growPx) : toView_(v.cloudToView) {
        const glm::dvec2 half(v.width * 0.5 + growPx, v.height * 0.5 + growPx);
        for (int a = 0; a < 2; ++a)
            for (const double side : {1.0, -1.0}) {
                glm::dvec4 plane(0);
                plane[a] = side;
                if (v.projection == Projection::Perspective)
                    plane.z = -half[a] / v.pixelsPerUnit;  // depth is -z
                else
                    plane.w = half[a] / v.pixelsPerUnit;
                add(plane);
            }
        add({0, 0, -1, -v.near});
        if (std::isfinite(v.far)) add({0, 0, 1, v.far});
    }

    /// Whether nothing in the node's bounds, grown by a length, is inside.
    bool misses(const Node& n, double grow) const {
        // Devices compute depths in single precision: what they find on a plane must not be culled here.
        const glm::dvec4 center = toView_ * glm::dvec4(n.center, 1);
        grow += 1e-6 * (std::abs(center.x) + std::abs(center.y) + std::abs(center.z) + n.radius);
        for (int i = 0; i < count_; ++i) {
            const glm::dvec3 normal(planes_[i]);
            if (glm::dot(normal, n.center) + planes_[i].w + n.radius + grow < 0) return true;
            const glm::dvec3 corner(normal.x > 0 ? n.boxMax.x : n.boxMin.x,
                                    normal.y > 0 ? n.boxMax.y : n.boxMin.y,
                                    normal.z > 0 ? n.boxMax.z : n.boxMin.z);
            if (glm::dot(normal, corner) + planes_[i].w + grow < 0) return true;
        }
        return false;
    }

  private:
    void add(const glm::dvec4& viewPlane) {
        const glm::dvec4 plane =
            viewPlane * toView_;  // a row vector: planes transform by the transposed inverse
        planes_[count_++] = plane / glm::length(glm::dvec3(plane));
    }

    glm::dmat4 toView_;
    std::array<glm::dvec4, 6> planes_{};
    int count_ = 0;
};

// Half a pixel of anti-aliasing jitter, and half for the pixel that holds the splat's centre.
constexpr double alwaysGrowPx = 1;

/// Whether every surface element with a normal in the node's cone and a place in its sphere is seen from
/// behind: no direction of sight to the sphere leans more than asin(R/D) from the one to its centre, no
/// normal more than the half-angle from the axis (methods.md §6).
bool facesAway(const Node& n, const Viewpoint& viewpoint, const glm::dvec3& eye) {
    constexpr double rightAngle = std::numbers::pi / 2;
    constexpr double slack = 1e-4;  // devices turn normals in single precision
    double spread = n.cone.halfAngle + slack;
    glm::dvec3 sight = viewpoint.direction();
    if (viewpoint.projection == Projection::Perspective) {
        sight = n.center - eye;
        const double distance = glm::length(sight);
        if (!(distance > n.radius)) return false;
        spread += std::asin(n.radius / distance);
        sight /= distance;
    }
    if (!(spread < rightAngle)) return false;
    const double cosine = glm::dot(glm::normalize(glm::dvec3(n.cone.axis)), sight);
    return cosine > std::cos(rightAngle - spread);
}

class Selection {
  public:
    Selection(const Octree& octree, const Viewpoint& viewpoint, const SelectOptions& options)
        : octree_(octree),
          viewpoint_(viewpoint),
          options_(options),
          eye_(viewpoint.eye()),
          frustum_(viewpoint, options.growPx + alwaysGrowPx) {}

    Cut run() {
        if (octree_.nodes().empty()) return std::move(cut_);
        if (options_.bruteForce)
            drawLeaves();
        else if (options_.budget)
            refineWithinBudget(*options_.budget);
        else
            refineAll();
        number(cut_);
        return std::move(cut_);
    }

  private:
    /// Sample spacing as it appears in the picture, px, where the node comes nearest to the eye.
    double projected(const Node& n) const {
        if (viewpoint_.projection == Projection::Orthographic) return n.meanSpacing * viewpoint_.q(1);
        const double distance = glm::length(n.center - eye_) - n.radius;
        return n.meanSpacing *
               viewpoint_.q(std::max({viewpoint_.near, distance, std::numeric_limits<double>::min()}));
    }

    bool culled(const Node& n) {
        ++cut_.nodesVisited;
        if (options_.cull && frustum_.misses(n, options_.growSpacings * n.spacing)) {
            ++cut_.nodesCulled;
            return true;
        }
        if (options_.cullBackFaces && facesAway(n, viewpoint_, eye_)) {
            ++cut_.nodesCulled;
            ++cut_.nodesFacingAway;
            return true;
        }
        return false;
    }

    void draw(std::uint32_t index) {
        const Node& n = octree_.node(index);
        CutRun run;
        run.node = &n;
        run.nodeIndex = index;
        run.projected = projected(n);
        cut_.runs.push_back(run);
    }

    bool wantsRefining(const Node& n, double spacing) const {
        return !n.isLeaf() && spacing > options_.detail;
    }

    void drawLeaves() {
        for (std::uint32_t i = 0; i < octree_.nodes().size(); ++i) {
            ++cut_.nodesVisited;
            if (octree_.node(i).isLeaf()) draw(i);
        }
    }

    /// Without a budget the order does not matter; first in, first out visits nodes in the order of their
    /// index.
    void refineAll() {
        std::vector<std::uint32_t> queue;
        if (!culled(octree_.node(0))) queue.push_back(0);
        for (std::size_t at = 0; at < queue.size(); ++at) {
            const Node& n = octree_.node(queue[at]);
            if (!wantsRefining(n, projected(n))) {
                draw(queue[at]);
                continue;
            }
            ++cut_.nodesRefined;
            for (std::uint32_t c = n.firstChild; c < n.firstChild + n.childCount; ++c)
                if (!culled(octree_.node(c))) queue.push_back(c);
        }
    }

    struct Candidate {
        double spacing;
        std::uint32_t index;
        bool operator<(const Candidate& o) const {  // the top of the queue is the largest
            return spacing != o.spacing ? spacing < o.spacing : index > o.index;
        }
    };

    /// Coarsest first, so that the budget goes where it is missed most; the first node that would exceed it
    /// ends it.
    void refineWithinBudget(std::uint64_t budget) {
        std::priority_queue<Candidate> queue;
        std::vector<std::uint32_t> chosen;
        std::uint64_t samples = 0;
        const auto enter = [&](std::uint32_t index) {
            const Node& n = octree_.node(index);
            const double spacing = projected(n);
            samples += n.sampleCount;
            if (wantsRefining(n, spacing))
                queue.push({spacing, index});
            else
                chosen.push_back(index);
        };
        if (!culled(octree_.node(0))) enter(0);
        while (!queue.empty()) {
            const Node& n = octree_.node(queue.top().index);
            const std::vector<std::uint32_t> children = visibleChildren(n);
            std::uint64_t after = samples - n.sampleCount;
            for (const std::uint32_t c : children) after += octree_.node(c).sampleCount;
            if (after > std::max(budget, samples)) {
                cut_.budgetReached = true;
                break;
            }
            queue.pop();
            samples -= n.sampleCount;
            ++cut_.nodesRefined;
            for (const std::uint32_t c : children) enter(c);
        }
        for (; !queue.empty(); queue.pop()) chosen.push_back(queue.top().index);
        std::sort(chosen.begin(), chosen.end());
        for (const std::uint32_t index : chosen) draw(index);
    }

    std::vector<std::uint32_t> visibleChildren(const Node& n) {
        std::vector<std::uint32_t> children;
        for (std::uint32_t c = n.firstChild; c < n.firstChild + n.childCount; ++c)
            if (!culled(octree_.node(c))) children.push_back(c);
        return children;
    }

    const Octree& octree_;
    const Viewpoint& viewpoint_;
    const SelectOptions& options_;
    glm::dvec3 eye_;
    GrownFrustum frustum_;
    Cut cut_;
};

}  // namespace

void number(Cut& cut) {
    cut.samples = cut.points = 0;
    cut.spacingReached = 0;
    for (CutRun& run : cut.runs) {
        run.firstOrdinal = std::uint32_t(cut.samples);
        cut.samples += run.node->sampleCount;
        cut.points += run.node->points;
        cut.spacingReached = std::max(cut.spacingReached, run.projected);
    }
}

Cut select(const Octree& octree, const Viewpoint& viewpoint, const SelectOptions& options) {
    return Selection(octree, viewpoint, options).run();
}

}  // namespace scancast
