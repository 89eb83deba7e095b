#include "server/stream/quality.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {
namespace {

// τ = 0 means "to the leaves"; for the cost model it counts as this.
constexpr double finestDetail = 0.25;
// Sizes come in steps of this share, so that a client does not see a new size with every frame.
constexpr double resolutionStep = 1.0 / 8;
// Part of a frame's time that rendering may take; the rest is encoding's and the network's.
constexpr double renderShare = 0.9;

double coarsestDetail(double ownDetail, const MovingLimits& limits) {
    return std::max({limits.maxDetail, ownDetail, finestDetail});
}

}  // namespace

double leastEffort(double ownDetail, const MovingLimits& limits) {
    const double detail = std::max(ownDetail, finestDetail) / coarsestDetail(ownDetail, limits);
    const double side = detail * limits.minResolution;
    return side * side;
}

double nextEffort(double effort, double renderMs, double ownDetail, const MovingLimits& limits) {
    const double allowedMs = renderShare * 1000 / limits.fps;
    const double ideal = effort * allowedMs / std::max(renderMs, 1e-3);
    return std::clamp(std::min(ideal, effort * 1.25), leastEffort(ownDetail, limits), 1.0);
}

MovingPlan planMoving(double effort, double ownDetail, const MovingLimits& limits) {
    MovingPlan plan;
    plan.detail = ownDetail;
    if (effort >= 1) return plan;
    const double own = std::max(ownDetail, finestDetail);
    plan.detail = std::min(own / std::sqrt(effort), coarsestDetail(ownDetail, limits));
    const double left = std::sqrt(effort) * plan.detail / own;
    plan.resolution =
        std::clamp(std::ceil(left / resolutionStep - 1e-9) * resolutionStep, limits.minResolution, 1.0);
    return plan;
}

View movingView(const View& wanted, double ownDetail, double effort, const MovingLimits& limits) {
    const MovingPlan plan = planMoving(effort, ownDetail, limits);
    View view = wanted;
    view.quality.samples = 1;
    view.quality.detail = plan.detail;
    // Rounded up: never below the limit that the client set.
    view.width = std::clamp(int(std::ceil(wanted.width * plan.resolution)), 1, wanted.width);
    view.height = std::clamp(int(std::ceil(wanted.height * plan.resolution)), 1, wanted.height);
    return view;
}

}  // namespace scancast
