#include "renderer/device/host/splats.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <glm/geometric.hpp>

#include "renderer/cloud/surfel_bytes.hpp"
#include "renderer/device/host/colors.hpp"
#include "renderer/select/fade.hpp"

namespace scancast {
namespace {

// ---- passes

void setSizes(const Splat& splat, SplatPass& n) {
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

SplatPass splatPass(const Splat& splat, const LayerView& view, const ColorRule& color) {
    const Viewpoint& viewpoint = *view.viewpoint;
    SplatPass n;
    n.shape = splatShape(splat.footprint, splat.profile);
    n.perspective = view.perspective();
    n.near = std::max(static_cast<float>(viewpoint.near), FLT_MIN);
    n.far = std::min(static_cast<float>(viewpoint.far), farthestDepth);
    setSizes(splat, n);
    n.radiusPerPixel = static_cast<float>(std::min(1 / viewpoint.pixelsPerUnit, 1e30));
    n.gain = splat.profile == Profile::Flat || !(splat.gain > 0) ? 0.0f : std::min(splat.gain, 1000.0f);
    n.pixelsPerUnit = static_cast<float>(std::min(viewpoint.pixelsPerUnit, largestCoefficient));
    n.scale = splat.size.scale;
    if (splat.footprint == Footprint::Ellipse) {
        n.lowPassPx = splat.lowPassPx;
        n.ratioStep = splat.round ? 0 : axisRatioStep;
    }
    if (view.anyOriented())
        n.facing = splat.facing == Facing::Front ? 1 : splat.facing == Facing::Back ? -1 : 0;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) n.rotation[r][c] = static_cast<float>(viewpoint.cloudToView[c][r]);
    }
    const bool fixed = splat.footprint == Footprint::Pixel || (!ofSurfels(splat) && splat.size.sizePx > 0);
    n.ownRadii = view.surfels && !fixed;
    setColors(color, n);
    return jittered(n, view, {0, 0});
}

// ---- runs

/// First and last integer i in [0, 65535] with low ≤ base + step · i ≤ high, as octree.hpp's position()
/// computes it.
bool clipAxis(double base, double step, double low, double high, std::int32_t& first, std::int32_t& last) {
    const auto place = [&](std::int32_t i) { return base + step * i; };
    const auto rounded = [](double v) { return static_cast<std::int32_t>(std::clamp(v, -1.0, 65536.0)); };
    first = std::max(0, rounded((low - base) / step) - 1);
    while (first <= 65535 && place(first) < low) ++first;
    last = std::min(65535, rounded((high - base) / step) + 1);
    while (last >= 0 && place(last) > high) --last;
    return first <= last;
}

/// False: the clip box leaves nothing of the node.
bool setClip(const Node& node, const SampleFilter& filter, RunNumbers& run) {
    std::fill_n(run.clipMax, 3, 65535);
    if (!filter.clip) return true;
    const ClipBox& box = *filter.clip;
    for (int a = 0; a < 3; ++a) {
        if (!clipAxis(node.boxMin[a], node.step[a], box.min[a], box.max[a], run.clipMin[a], run.clipMax[a])) {
            return false;
        }
        run.clipped |= run.clipMin[a] > 0 || run.clipMax[a] < 65535;
    }
    return true;
}

/// Least and greatest value of a plane over a node's samples.
std::array<double, 2> valuesOf(const glm::dvec4& plane, const Node& node) {
    const glm::dvec3 half = (node.boxMax - node.boxMin) * 0.5 + node.step;
    const glm::dvec3 center = (node.boxMax + node.boxMin) * 0.5;
    const double middle = glm::dot(glm::dvec3(plane), center) + plane.w;
    const double reach = std::abs(plane.x) * half.x + std::abs(plane.y) * half.y + std::abs(plane.z) * half.z;
    return {middle - reach, middle + reach};
}

/// Of a sample's integers. Planes across an axis part whole numbers, exactly where position() parts them: what lies on a
/// level face is on one side of it, whatever single precision makes of it.
void setRow(const glm::dvec4& plane, const Node& node, float (&row)[4]) {
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        if (plane[b] != 0 || plane[c] != 0) continue;
        const bool up = plane[a] > 0;
        const double border = -plane.w / plane[a];
        std::int32_t first = 0, last = 0;
        clipAxis(node.boxMin[a], node.step[a], up ? border : -INFINITY, up ? INFINITY : border, first, last);
        row[a] = up ? 1.0f : -1.0f;
        row[b] = row[c] = 0;
        row[3] = up ? 0.5f - static_cast<float>(first) : 0.5f + static_cast<float>(last);
        return;
    }
    for (int a = 0; a < 3; ++a) row[a] = static_cast<float>(plane[a] * node.step[a]);
    row[3] = static_cast<float>(glm::dot(glm::dvec3(plane), node.boxMin) + plane.w);
}

/// The planes of a region that cross the node: none where all of it lies inside. nullopt: nothing of it does.
std::optional<RunRegion> crossingPlanes(const Region& region, const Node& node) {
    RunRegion crossing;
    for (int i = 0; i < region.count; ++i) {
        const glm::dvec4& plane = region.planes[static_cast<std::size_t>(i)];
        const auto [low, high] = valuesOf(plane, node);
        if (high < 0) return std::nullopt;
        if (low < 0) setRow(plane, node, crossing.planes[crossing.count++]);
    }
    return crossing;
}

void setColor(const CutRun& cutRun, const ColorRule& rule, RunNumbers& run) {
    if (rule.source == ColorSource::Flat) run.color = packed(rule.flat);
    if (rule.source == ColorSource::Lod) run.color = packed(rule.ramp[cutRun.node->level]);
    const double scale = indexScale(rule.low, rule.high);
    if (rule.source == ColorSource::Curvature) {
        run.indexStep = static_cast<float>(0.5 * scale / cutRun.node->radiusUnit);
        run.indexBase = static_cast<float>(-rule.low * scale);
        return;
    }
    run.indexStep = static_cast<float>(cutRun.node->step.z * scale);
    run.indexBase = static_cast<float>((cutRun.node->boxMin.z - rule.low) * scale);
}

}  // namespace

SplatShape splatShape(Footprint footprint, Profile profile) {
    if (footprint == Footprint::Disc) return SplatShape::Disc;
    if (footprint == Footprint::Ellipse) return SplatShape::Ellipse;
    const bool square = footprint != Footprint::Circle;
    switch (profile) {
        case Profile::Flat:
            return square ? SplatShape::FlatSquare : SplatShape::FlatCircle;
        case Profile::Paraboloid:
            return square ? SplatShape::ParaboloidSquare : SplatShape::ParaboloidCircle;
        case Profile::Cone:
            return square ? SplatShape::ConeSquare : SplatShape::ConeCircle;
        case Profile::Sphere:
            return SplatShape::SphereCircle;
    }
    return SplatShape::FlatSquare;
}

const char* nameOf(const SplatPass& pass) {
    if (pass.silhouette) return "silhouette";
    if (pass.reduction == Reduction::Sum) return "sum";
    return pass.reduction == Reduction::Cell ? "cell" : "nearest";
}

SplatPass jittered(SplatPass pass, const LayerView& view, const glm::dvec2& jitter) {
    const glm::dvec2 center = view.center() + jitter;
    pass.centerX = static_cast<float>(center.x);
    pass.centerY = static_cast<float>(center.y);
    return pass;
}

std::vector<SplatPass> splatPasses(const FramePasses& passes, const LayerView& view, const ColorRule& color) {
    std::vector<SplatPass> out;
    const auto add = [&](const Splat& splat) -> SplatPass& {
        return out.emplace_back(splatPass(splat, view, color));
    };
    // Without a known front there is no back to make a silhouette of.
    if (passes.silhouette && view.anyOriented()) add(*passes.silhouette).silhouette = true;
    add(passes.nearest).payload = passes.bySurface()                          ? SplatPayload::Surface
                                  : passes.nearest.payload == Payload::Sample ? SplatPayload::Sample
                                                                              : SplatPayload::Color;
    if (passes.cell) {
        SplatPass& n = add(*passes.cell);
        n.reduction = Reduction::Cell;
        n.payload = passes.bySample() ? SplatPayload::Sample : SplatPayload::Surface;
        n.tolerance = passes.cell->tolerance;
    }
    if (passes.sum) {
        SplatPass& n = add(*passes.sum);
        n.reduction = Reduction::Sum;
        n.sumNormals = passes.sum->normals;
        n.curved = view.curvatures && passes.sum->normals && passes.sum->curved &&
                   passes.sum->footprint == Footprint::Ellipse;
        if (passes.cell) {
            n.reach = passes.sum->reach;
            // A little more, so that rounding never leaves out the cell's own disc.
            n.tolerance = 1.01f * passes.cell->tolerance;
        }
    }
    if (passes.bySample())
        for (SplatPass& n : out)
            n.curved = view.curvatures && passes.resolve.normals && passes.resolve.curved;
    return out;
}

/// Rows: across the picture, down it (rows grow downwards), into it. As shaders/splat/compose_runs.comp does it, sum by
/// sum.
bool composeToPicture(const glm::dvec3& corner, const glm::dvec3& step, const glm::dmat4& cloudToView,
                      double pixelsPerUnit, float (&rows)[3][4]) {
    const glm::dmat4& m = cloudToView;
    const double scale[3] = {pixelsPerUnit, -pixelsPerUnit, -1};
    for (int r = 0; r < 3; ++r) {
        const double base = (m[0][r] * corner.x + m[1][r] * corner.y) + (m[2][r] * corner.z + m[3][r]);
        for (int c = 0; c < 4; ++c) {
            const double value = scale[r] * (c < 3 ? m[c][r] * step[c] : base);
            if (!(std::abs(value) < largestCoefficient)) return false;
            rows[r][c] = static_cast<float>(value);
        }
    }
    return true;
}

std::optional<RunNumbers> runFacts(const CutRun& cutRun, const LayerView& view, const ColorRule& color,
                                   const SampleFilter& filter) {
    const Node& node = *cutRun.node;
    RunNumbers run;
    if (!setClip(node, filter, run)) return std::nullopt;
    setColor(cutRun, color, run);
    // Devices count radii from the run's plain one, which holds for samples that know none.
    run.plainRadius = node.spacing;
    run.ratioUnit = node.radiusUnit / node.spacing;
    run.oriented = view.oriented || (view.orientedNodes && node.confidence >= sureSide);
    run.hasBeside = !cutRun.beside.empty();
    run.firstOrdinal = cutRun.firstOrdinal;
    run.turnStep = turnStep;
    run.turnBase = 0u - cutRun.firstOrdinal * turnStep;
    run.lastTurn = lastTurn(cutRun.share);
    return run;
}

std::optional<RunNumbers> runNumbers(const CutRun& cutRun, const LayerView& view, const ColorRule& color,
                                     const SampleFilter& filter) {
    auto run = runFacts(cutRun, view, color, filter);
    const Node& node = *cutRun.node;
    const Viewpoint& viewpoint = *view.viewpoint;
    if (run && !composeToPicture(node.boxMin, node.step, viewpoint.cloudToView, viewpoint.pixelsPerUnit,
                                 run->toPicture))
        return std::nullopt;
    return run;
}

std::optional<RunRegions> runRegions(const Node& node, const SampleFilter& filter) {
    RunRegions out;
    for (const auto* const dropped : {&filter.shapes.dropped, &filter.dropped}) {
        for (const Region& region : *dropped) {
            const auto crossing = crossingPlanes(region, node);
            if (crossing && crossing->count == 0) return std::nullopt;
            if (crossing) out.regions.push_back(*crossing);
        }
    }
    out.dropped = static_cast<std::int32_t>(out.regions.size());
    if (filter.shapes.kept.empty()) return out;
    for (const Region& region : filter.shapes.kept) {
        const auto crossing = crossingPlanes(region, node);
        if (crossing && crossing->count == 0) {  // all of it is kept
            out.regions.resize(static_cast<std::size_t>(out.dropped));
            return out;
        }
        if (crossing) out.regions.push_back(*crossing);
    }
    out.kept = static_cast<std::int32_t>(out.regions.size()) - out.dropped;
    if (out.kept == 0) return std::nullopt;
    return out;
}

}  // namespace scancast
