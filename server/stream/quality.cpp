#include "server/stream/quality.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {
namespace {

// τ = 0 means "to the leaves"; for the cost model it counts as this.
constexpr double finestDetail = 0.25;

double coarsestDetail(double ownDetail, const MovingLimits& limits) {
    return std::max({limits.maxDetail, ownDetail, finestDetail});
}

// Rounded up to a step; measured times tremble, so the size before is kept a quarter of a step beyond its
// own. Not where nothing larger than the least is affordable: there every pixel more makes frames fewer than wanted.
double steadyResolution(double affordable, double before, double least) {
    if (affordable <= least + 1e-9) return least;
    const bool near = before > 0 && affordable <= before + resolutionStep / 4 &&
                      affordable > before - resolutionStep * 5 / 4;
    const double steps = std::ceil(affordable / resolutionStep - 1e-9) * resolutionStep;
    return std::clamp(near ? before : steps, least, 1.0);
}

}  // namespace

double leastEffort(double ownDetail, const MovingLimits& limits) {
    const double detail = std::max(ownDetail, finestDetail) / coarsestDetail(ownDetail, limits);
    const double side = detail * limits.minResolution;
    return side * side;
}

double costOf(const MovingQuality& quality, double ownDetail) {
    const double own = std::max(ownDetail, finestDetail);
    const double side = own / std::max(quality.detail, own) * quality.resolution;
    return side * side;
}

double nextEffort(const MovingQuality& quality, double milliseconds, double ownDetail,
                  const MovingLimits& limits) {
    const double allowedMs = usableShare * 1000 / limits.fps;
    const double ideal = costOf(quality, ownDetail) * allowedMs / std::max(milliseconds, 1e-3);
    return std::clamp(std::min(ideal, quality.effort * 1.25), leastEffort(ownDetail, limits), 1.0);
}

MovingQuality movingQuality(double effort, double ownDetail, const MovingLimits& limits, double before) {
    MovingQuality quality;
    quality.effort = effort;
    quality.detail = ownDetail;
    if (effort >= 1) return quality;
    const double own = std::max(ownDetail, finestDetail);
    quality.detail = std::min(own / std::sqrt(effort), coarsestDetail(ownDetail, limits));
    const double left = std::sqrt(effort) * quality.detail / own;
    quality.resolution = steadyResolution(left, before, limits.minResolution);
    return quality;
}

View movingView(const View& wanted, const MovingQuality& quality) {
    View view = wanted;
    view.quality.samples = 1;
    view.quality.detail = quality.detail;
    view.quality.jpegQuality = quality.jpegQuality;
    view.quality.subsampling = quality.subsampling;
    // Rounded up: never below the limit that the client set.
    view.width = std::clamp(int(std::ceil(wanted.width * quality.resolution)), 1, wanted.width);
    view.height = std::clamp(int(std::ceil(wanted.height * quality.resolution)), 1, wanted.height);
    return view;
}

}  // namespace scancast
