#include "renderer/device/plan/stages.hpp"

#include <algorithm>
#include <cfloat>

#include "renderer/device/plan/colors.hpp"
#include "renderer/device/plan/splat_plan.hpp"

namespace scancast {
namespace {

void setSizes(const Splat& splat, SplatNumbers& n) {
    // A size of nothing would divide by nothing; the centre's pixel is drawn anyway.
    const auto bounded = [](float px) { return px > 1e-3f ? std::min(px, 16384.0f) : 1e-3f; };
    if (splat.footprint == Footprint::Pixel) {
        n.minPx = n.maxPx = 1;
    } else if (splat.size.sizePx > 0) {
        n.minPx = n.maxPx = bounded(splat.size.sizePx);
    } else {
        n.minPx = bounded(splat.size.minPx);
        n.maxPx = std::max(bounded(splat.size.maxPx), n.minPx);
    }
}

SplatStage makeStage(SplatStage::Kind kind, const Splat& splat, const Sight& sight, const ColorRule& color) {
    const Viewpoint& viewpoint = *sight.viewpoint;
    SplatStage stage;
    stage.kind = kind;
    stage.splat = splat;
    SplatNumbers& n = stage.numbers;
    n.shape = splatShape(splat.footprint, splat.profile);
    n.perspective = sight.perspective();
    n.near = std::max(static_cast<float>(viewpoint.near), FLT_MIN);
    n.far = std::min(static_cast<float>(viewpoint.far), farthestDepth);
    setSizes(splat, n);
    n.radiusPerPixel = static_cast<float>(std::min(1 / viewpoint.pixelsPerUnit, 1e30));
    n.gain = splat.profile == Profile::Flat || !(splat.gain > 0) ? 0.0f : std::min(splat.gain, 1000.0f);
    n.pixelsPerUnit = static_cast<float>(std::min(viewpoint.pixelsPerUnit, largestCoefficient));
    n.scale = splat.size.scale;
    if (splat.footprint == Footprint::Ellipse) n.lowPassPx = splat.lowPassPx;
    n.oriented = sight.oriented;
    if (sight.oriented) n.facing = splat.facing == Facing::Front ? 1 : splat.facing == Facing::Back ? -1 : 0;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) n.rotation[r][c] = static_cast<float>(viewpoint.cloudToView[c][r]);
    }
    const bool fixed = splat.footprint == Footprint::Pixel || (!ofSurfels(splat) && splat.size.sizePx > 0);
    n.ownRadii = sight.surfels && !fixed;
    setColors(color, n);
    n = jittered(n, sight, {0, 0});
    return stage;
}

}  // namespace

SplatNumbers jittered(const SplatNumbers& numbers, const Sight& sight, const glm::dvec2& jitter) {
    SplatNumbers moved = numbers;
    const glm::dvec2 center = sight.center() + jitter;
    moved.centerX = static_cast<float>(center.x);
    moved.centerY = static_cast<float>(center.y);
    return moved;
}

std::vector<SplatStage> splatStages(const PassPlan& plan, const Sight& sight, const ColorRule& color) {
    using enum SplatStage::Kind;
    std::vector<SplatStage> stages;
    const auto add = [&](SplatStage::Kind kind, const Splat& splat) -> SplatNumbers& {
        return stages.emplace_back(makeStage(kind, splat, sight, color)).numbers;
    };
    // Without a known front there is no back to make a silhouette of.
    if (plan.silhouette && sight.oriented) add(Silhouette, *plan.silhouette);
    add(Nearest, plan.nearest).payloadSample = plan.nearest.payload == Payload::Sample;
    if (plan.sum) {
        SplatNumbers& n = add(Sum, *plan.sum);
        n.reduction = Reduction::Sum;
        n.sumNormals = plan.sum->normals;
        if (plan.sum->footprint == Footprint::Disc) {
            n.reach = plan.sum->reach;
            n.tolerance = plan.cell ? plan.cell->tolerance : 0.5f;
        }
    }
    if (plan.cell) {
        SplatNumbers& n = add(Cell, *plan.cell);
        n.reduction = Reduction::Cell;
        n.payloadSample = true;
        n.tolerance = plan.cell->tolerance;
    }
    return stages;
}

}  // namespace scancast
