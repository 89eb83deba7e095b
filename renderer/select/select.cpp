#include "renderer/select/select.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <numbers>
#include <queue>

#include "renderer/select/fade.hpp"

namespace scancast {

namespace {

/// The view volume with its sides moved out by some pixels, and what else bounds what is drawn. Planes are
/// cloud-relative with unit normals; inside is dot(n, p) + w ≥ 0.
class GrownFrustum {
  public:
    GrownFrustum(const Viewpoint& v, const SelectOptions& options, double growPx) : toView_(v.cloudToView) {
        const auto part =
            options.part.value_or(std::array<double, 4>{0, 0, double(v.width), double(v.height)});
        const double x = v.width * 0.5, y = v.height * 0.5;
        // px from the view axis: right of the left side, left of the right one; the picture's y grows
        // downwards.
        addSide(v, 0, 1, x - part[0] + growPx);
        addSide(v, 0, -1, part[2] - x + growPx);
        addSide(v, 1, 1, part[3] - y + growPx);
        addSide(v, 1, -1, y - part[1] + growPx);
        add({0, 0, -1, -v.near});
        if (std::isfinite(v.far)) add({0, 0, 1, v.far});
        planes_.insert(planes_.end(), options.inFrontOf.begin(), options.inFrontOf.end());
    }

    /// Whether nothing in the node's bounds, grown by a length, is inside.
    bool misses(const Node& n, double grow) const {
        // Devices compute depths in single precision: what they find on a plane must not be culled here.
        const glm::dvec4 center = toView_ * glm::dvec4(n.center, 1);
        grow += 1e-6 * (std::abs(center.x) + std::abs(center.y) + std::abs(center.z) + n.radius);
        return std::ranges::any_of(planes_,
                                   [&](const glm::dvec4& plane) { return liesBehind(plane, n, grow); });
    }

  private:
    static bool liesBehind(const glm::dvec4& plane, const Node& n, double grow) {
        const glm::dvec3 normal(plane);
        if (glm::dot(normal, n.center) + plane.w + n.radius + grow < 0) return true;
        const glm::dvec3 corner(normal.x > 0 ? n.boxMax.x : n.boxMin.x,
                                normal.y > 0 ? n.boxMax.y : n.boxMin.y,
                                normal.z > 0 ? n.boxMax.z : n.boxMin.z);
        return glm::dot(normal, corner) + plane.w + grow < 0;
    }
    /// A side of the picture, `px` from the view axis.
    void addSide(const Viewpoint& v, int axis, double inwards, double px) {
        glm::dvec4 plane(0);
        plane[axis] = inwards;
        if (v.projection == Projection::Perspective)
            plane.z = -px / v.pixelsPerUnit;  // depth is -z
        else
            plane.w = px / v.pixelsPerUnit;
        add(plane);
    }
    void add(const glm::dvec4& viewPlane) {
        const glm::dvec4 plane =
            viewPlane * toView_;  // a row vector: planes transform by the transposed inverse
        planes_.push_back(plane / glm::length(glm::dvec3(plane)));
    }

    glm::dmat4 toView_;
    std::vector<glm::dvec4> planes_;
};

// Half a pixel of anti-aliasing jitter, and half for the pixel that holds the splat's centre.
constexpr double alwaysGrowPx = 1;

/// Whether every surface element with a normal in the node's cone and a place in its sphere is seen from
/// behind: no direction of sight to the sphere leans more than asin(R/D) from the one to its centre, no
/// normal more than the half-angle from the axis (docs/spec/hierarchy.md §6).
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

/// Whether box and shapes leave nothing of the node's samples, nor of those below it. Bounds are grown by a step, as
/// devices grow them, which look at the samples of what crosses a face in single precision.
bool clippedAway(const Node& n, const SelectOptions& options) {
    const glm::dvec3 low = n.boxMin - n.step, high = n.boxMax + n.step;
    if (options.clip)
        for (int a = 0; a < 3; ++a)
            if (high[a] < options.clip->min[a] || low[a] > options.clip->max[a]) return true;
    return !options.shapes.empty() && options.shapes.overlap(low, high) == Overlap::None;
}

class Selection {
  public:
    Selection(const Octree& octree, const Viewpoint& viewpoint, const SelectOptions& options)
        : octree_(octree),
          viewpoint_(viewpoint),
          options_(options),
          eye_(viewpoint.eye()),
          frustum_(viewpoint, options, options.growPx + alwaysGrowPx) {}

    Cut run() {
        if (octree_.nodes().empty()) return std::move(cut_);
        if (options_.bruteForce)
            drawLeaves();
        else if (options_.budget && options_.fade > 0)
            fadeWithinBudget(*options_.budget);
        else if (options_.budget)
            refineWithinBudget(*options_.budget);
        else
            refineAll(options_.detail);
        cut_.source = octree_.source();
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
        if (options_.cull && clippedAway(n, options_)) {
            ++cut_.nodesCulled;
            ++cut_.nodesClipped;
            return true;
        }
        if (options_.cullBackFaces && (!options_.sureNodesOnly || n.confidence >= sureSide) &&
            facesAway(n, viewpoint_, eye_)) {
            ++cut_.nodesCulled;
            ++cut_.nodesFacingAway;
            return true;
        }
        return false;
    }

    CutRun& draw(std::uint32_t index) {
        const Node& n = octree_.node(index);
        CutRun& run = cut_.runs.emplace_back();
        run.node = &n;
        run.nodeIndex = index;
        run.projected = projected(n);
        return run;
    }

    bool wantsRefining(const Node& n, double spacing) const {
        return !n.isLeaf() && spacing > options_.detail;
    }

    void drawLeaves() {
        cut_.runs.reserve(octree_.nodes().size());
        for (std::uint32_t i = 0; i < octree_.nodes().size(); ++i) {
            ++cut_.nodesVisited;
            if (octree_.node(i).isLeaf()) draw(i);
        }
    }

    struct Visit {
        std::uint32_t index;
        double share;  ///< what its ancestors leave of it
        bool covered;
    };

    /// Without a budget the order does not matter; first in, first out visits nodes in the order of their
    /// index.
    void refineAll(double detail) {
        std::vector<Visit> queue;
        for (std::uint32_t root = 0; root < octree_.roots(); ++root)
            if (!culled(octree_.node(root))) queue.push_back({root, 1, false});
        for (std::size_t at = 0; at < queue.size(); ++at) {
            const Visit visit = queue[at];
            const Node& n = octree_.node(visit.index);
            const FadeShares shares =
                n.isLeaf() ? FadeShares{} : fadeShares(projected(n), detail, options_.fade);
            // Less than a sample is none.
            const bool drawn = visit.share * shares.own * n.sampleCount >= 1;
            if (drawn) {
                CutRun& run = draw(visit.index);
                run.share = visit.share * shares.own;
                run.covered = visit.covered;
            }
            if (!(visit.share * shares.children > 0)) continue;
            ++cut_.nodesRefined;
            for (std::uint32_t c = n.firstChild; c < n.firstChild + n.childCount; ++c)
                if (!culled(octree_.node(c)))
                    queue.push_back({c, visit.share * shares.children, visit.covered || drawn});
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
        for (std::uint32_t root = 0; root < octree_.roots(); ++root)
            if (!culled(octree_.node(root))) enter(root);
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

    /// As if τ were as small as the budget allows. Every sample of a run counts, whatever its share: all must
    /// be in memory.
    void fadeWithinBudget(std::uint64_t budget) {
        refineAll(options_.detail);
        std::uint64_t samples = 0;
        for (const CutRun& run : cut_.runs) samples += run.node->sampleCount;
        if (samples <= budget) return;
        const double detail = affordableDetail(budget);
        cut_ = Cut();
        cut_.budgetReached = true;
        refineAll(detail);
    }

    /// Nodes of which children come or which leave, as τ falls below `detail`.
    struct Change {
        double detail;
        bool leaves;
        std::uint32_t index;
        bool operator<(const Change& o) const {  // the top of the queue is the largest τ
            if (detail != o.detail) return detail < o.detail;
            return leaves != o.leaves ? o.leaves : index > o.index;
        }
    };

    /// The τ at which, coming from coarse ones, the budget is used up.
    double affordableDetail(std::uint64_t budget) {
        std::priority_queue<Change> changes;
        std::uint64_t samples = 0;
        const auto enter = [&](std::uint32_t index, double parentsDetail) {
            const Node& n = octree_.node(index);
            const double spacing = projected(n);
            if (wantsRefining(n, spacing)) changes.push({std::min(spacing, parentsDetail), false, index});
        };
        for (std::uint32_t root = 0; root < octree_.roots(); ++root) {
            samples += octree_.node(root).sampleCount;
            enter(root, std::numeric_limits<double>::infinity());
        }
        while (!changes.empty()) {
            const Change change = changes.top();
            changes.pop();
            const Node& n = octree_.node(change.index);
            if (change.leaves) {
                samples -= n.sampleCount;
                continue;
            }
            const std::vector<std::uint32_t> children = visibleChildren(n);
            const double leaving = projected(n) / (1 + options_.fade);
            const bool leavesAtOnce = leaving >= change.detail;
            std::uint64_t after = samples - (leavesAtOnce ? n.sampleCount : 0);
            for (const std::uint32_t c : children) after += octree_.node(c).sampleCount;
            if (after > std::max(budget, samples)) return change.detail;
            samples = after;
            if (!leavesAtOnce) changes.push({leaving, true, change.index});
            for (const std::uint32_t c : children) enter(c, change.detail);
        }
        return options_.detail;
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

void dealOrdinals(Cut& cut) {
    std::uint64_t next = 0;
    for (CutRun& run : cut.runs) {
        run.firstOrdinal = std::uint32_t(next);
        next += std::max<std::uint64_t>(run.node->sampleCount, run.samples.size());
    }
}

void number(Cut& cut) {
    dealOrdinals(cut);
    cut.samples = cut.points = 0;
    cut.spacingReached = 0;
    for (CutRun& run : cut.runs) {
        cut.samples += run.node->sampleCount;
        if (!run.covered) cut.points += run.node->points;
        cut.spacingReached = std::max(cut.spacingReached, run.projected);
    }
}

Cut select(const Octree& octree, const Viewpoint& viewpoint, const SelectOptions& options) {
    return Selection(octree, viewpoint, options).run();
}

}  // namespace scancast
