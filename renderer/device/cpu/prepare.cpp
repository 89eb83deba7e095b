#include "renderer/device/cpu/prepare.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <glm/geometric.hpp>

#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/device/splat_plan.hpp"
#include "renderer/select/fade.hpp"

namespace scancast::cpu {
namespace {

static_assert(sizeof(Sample) == sizeof(SampleWords));
static_assert(sizeof(SampleLimits) == sizeof(BlockLimits) && samplesPerLimits == limitsStep);

/// View-space rows of a node: what its samples' integers are multiplied with, and the constant.
struct ViewRows {
    double step[3][3];
    double base[3];
};

ViewRows viewRows(const Node& node, const Viewpoint& viewpoint) {
    ViewRows rows;
    const glm::dvec4 base = viewpoint.cloudToView * glm::dvec4(node.boxMin, 1);
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) rows.step[r][c] = viewpoint.cloudToView[c][r] * node.step[c];
        rows.base[r] = base[r];
    }
    return rows;
}

bool setToPicture(const ViewRows& rows, double pixelsPerUnit, SplatRun& run) {
    // Across the picture, down it (rows grow downwards), into it.
    const double scale[3] = {pixelsPerUnit, -pixelsPerUnit, -1};
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 4; ++c) {
            const double value = scale[r] * (c < 3 ? rows.step[r][c] : rows.base[r]);
            if (!(std::abs(value) < largestCoefficient)) return false;
            run.toPicture[r][c] = static_cast<float>(value);
        }
    }
    return true;
}

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
bool setClip(const Node& node, const SampleFilter& filter, SplatRun& run) {
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

/// False: the whole node lies inside a dropped region.
bool setDropped(const Node& node, const SampleFilter& filter, PreparedRun& out) {
    std::vector<DroppedRegion> regions;
    for (const Region& region : filter.dropped) {
        DroppedRegion crossing;
        bool apart = false;
        for (int i = 0; i < region.count; ++i) {
            const glm::dvec4& plane = region.planes[static_cast<std::size_t>(i)];
            const auto [low, high] = valuesOf(plane, node);
            apart = apart || high < 0;
            if (low >= 0) continue;
            float* const row = crossing.planes[crossing.count++];
            for (int a = 0; a < 3; ++a) row[a] = static_cast<float>(plane[a] * node.step[a]);
            row[3] = static_cast<float>(glm::dot(glm::dvec3(plane), node.boxMin) + plane.w);
        }
        if (apart) continue;
        if (crossing.count == 0) return false;
        regions.push_back(crossing);
    }
    if (regions.empty()) return true;
    out.dropped = std::make_shared<const std::vector<DroppedRegion>>(std::move(regions));
    out.run.dropped = out.dropped->data();
    out.run.droppedCount = static_cast<std::int32_t>(out.dropped->size());
    return true;
}

void setColor(const CutRun& cutRun, const ColorRule& rule, const SplatPass& pass, SplatRun& run) {
    if (rule.source == ColorSource::Flat) run.color = packed(rule.flat);
    if (rule.source == ColorSource::Lod) run.color = packed(rule.ramp[cutRun.node->level]);
    const double scale = pass.colorScale;
    run.elevationStep = static_cast<float>(cutRun.node->step.z * scale);
    run.elevationBase = static_cast<float>((cutRun.node->boxMin.z - rule.low) * scale);
}

struct Depths {
    double nearest, farthest, error;
};

/// Depths of a node's box, and how far the kernel's floats may be off.
Depths depthsOf(const Node& node, const Viewpoint& viewpoint) {
    const glm::dvec3 half = (node.boxMax - node.boxMin) * 0.5 + node.step;
    const glm::dvec3 center = (node.boxMax + node.boxMin) * 0.5;
    const glm::dmat4& m = viewpoint.cloudToView;
    const double middle = -(m * glm::dvec4(center, 1)).z;
    const double reach = std::abs(m[0][2]) * half.x + std::abs(m[1][2]) * half.y + std::abs(m[2][2]) * half.z;
    return {middle - reach, middle + reach, 1e-6 * (std::abs(middle) + 4 * reach)};
}

/// Where the eight corners of the box land; only for boxes wholly in front of the eye.
Rect boundsOf(const Node& node, const Viewpoint& viewpoint, int pad, double grow) {
    double x0 = DBL_MAX, y0 = DBL_MAX, x1 = -DBL_MAX, y1 = -DBL_MAX;
    for (int corner = 0; corner < 8; ++corner) {
        glm::dvec4 p(node.boxMin - node.step, 1);
        for (int a = 0; a < 3; ++a) {
            if (corner >> a & 1) p[a] = node.boxMax[a] + node.step[a];
        }
        const glm::dvec4 v = viewpoint.cloudToView * p;
        const double q = viewpoint.q(-v.z);
        x0 = std::min(x0, q * v.x);
        x1 = std::max(x1, q * v.x);
        y0 = std::min(y0, -q * v.y);
        y1 = std::max(y1, -q * v.y);
    }
    const auto pixel = [](double v) { return static_cast<int>(std::clamp(v, -1e6, 1e6)); };
    const double x = viewpoint.width * 0.5 + pad, y = viewpoint.height * 0.5 + pad;
    return {pixel(std::floor(x + x0 - grow)), pixel(std::floor(y + y0 - grow)),
            pixel(std::ceil(x + x1 + grow)), pixel(std::ceil(y + y1 + grow))};
}

/// Cycles a sample costs, roughly: what tiles are balanced by.
double cyclesPerSample(const SplatStage& stage, float largestPx) {
    if (largestPx <= 1 && !ofSurfels(stage.splat)) return 10;
    const double rows = std::ceil(largestPx);
    const double chunks = std::ceil(rows / 8);
    const Shape shape = stage.pass.shape;
    const bool roots =
        shape == Shape::ConeCircle || shape == Shape::ConeSquare || shape == Shape::SphereCircle;
    double perChunk = roots ? 10 : 6;
    if (ofSurfels(stage.splat)) perChunk = 20;
    if (stage.kind == SplatStage::Kind::Sum) perChunk += 30;
    return (ofSurfels(stage.splat) ? 60 : 25) + rows * chunks * perChunk;
}

/// Kernels count radii from the run's plain one, which holds for samples that know none.
void setRadii(const CutRun& cutRun, bool ownRadii, SplatRun& run) {
    const Node& node = *cutRun.node;
    run.plainRadius = node.spacing;
    run.ratioUnit = node.radiusUnit / node.spacing;
    run.largestRatio = 1;
    if (!ownRadii) return;
    std::uint8_t largest = 0;
    bool plain = false;
    const auto add = [&](const SampleLimits& limits) {
        largest = std::max(largest, limits.largestRadius);
        plain = plain || limits.plain;
    };
    if (cutRun.limits.empty()) {
        std::ranges::for_each(limitsOf(cutRun.samples), add);
    } else {
        std::ranges::for_each(cutRun.limits, add);
    }
    const float ratio = surfelRadii()[largest] * run.ratioUnit;
    run.largestRatio = plain ? std::max(ratio, 1.0f) : ratio;
}

/// Half of the largest fragment's distance to its centre, seen from the nearest depth; px.
struct Extent {
    double px = 0;      ///< half the largest splat; infinite where the eye may be inside one
    double radius = 0;  ///< how far in front of its centre a fragment may lie, cloud units
};

Extent surfelExtent(const SplatStage& stage, const SplatRun& run, const Viewpoint& viewpoint, double front) {
    const bool ellipse = stage.splat.footprint == Footprint::Ellipse;
    double radius = double(run.plainRadius) * run.largestRatio * stage.pass.scale;
    if (ellipse) radius *= majorPerRadius;
    radius *= std::max(1.0f, stage.pass.reach);
    // Off the axis a disc appears larger by as much as its ray is longer.
    const double slope = 0.5 * std::hypot(viewpoint.width, viewpoint.height) / viewpoint.pixelsPerUnit;
    const bool perspective = viewpoint.projection == Projection::Perspective;
    const double stretch = perspective ? 1.5 * std::sqrt(1 + slope * slope) : 1.0;
    const double nearest = perspective ? front - radius : 1.0;
    double px = nearest > 0 ? stretch * radius * viewpoint.pixelsPerUnit / nearest : DBL_MAX;
    px = std::min(px, stretch * stretch * stage.pass.maxPx);
    // dz, with |n_xy/n_z| at its bound of 8.
    const double blur = 2.5 * 8 * stage.pass.lowPassPx / viewpoint.q(front);
    return {px + 2.5 * stage.pass.lowPassPx + 0.5, radius + blur};
}

/// How far behind the visible surface a fragment of the run may lie and still be drawn by the stage.
double tolerance(const SplatStage& stage, const SplatRun& run, const Viewpoint& viewpoint, double farthest,
                 double largestPx) {
    using enum SplatStage::Kind;
    if (stage.kind == Silhouette || stage.kind == Nearest) return 0;
    const double pixel = 1 / viewpoint.q(farthest);
    const double radius = double(run.plainRadius) * run.largestRatio * stage.pass.scale;
    switch (stage.splat.footprint) {
        case Footprint::Ellipse: {
            // 2a + 2dz, with |n_xy/n_z| at its bound of 8.
            const double a = radius * majorPerRadius;
            return 2 * a + 2 * (1.5 * a + 2.5 * 8 * stage.pass.lowPassPx * pixel);
        }
        case Footprint::Disc:
            return radius * stage.pass.tolerance;
        default:
            return 2 * (0.5 * largestPx) * pixel;
    }
}

/// Sizes in one pass; grows `grow` (px) and `reach` (cloud units) to what its splats need.
PassSize sizeIn(const SplatStage& stage, const SplatRun& run, const Viewpoint& viewpoint,
                const Depths& depths, double front, double& grow, double& reach) {
    PassSize size;
    double forward = 0;
    if (ofSurfels(stage.splat)) {
        const Extent extent = surfelExtent(stage, run, viewpoint, front);
        size.largestPx = static_cast<float>(std::min(2 * extent.px, 1e6));
        forward = extent.radius;
    } else {
        const double factor = 2.0 * run.plainRadius * stage.splat.size.scale * viewpoint.pixelsPerUnit;
        size.sizeFactor = static_cast<float>(std::clamp(factor, 0.0, 1e30));
        const bool perspective = viewpoint.projection == Projection::Perspective;
        const double grown = 1.000001 * factor * run.largestRatio / (perspective ? front : 1.0);
        size.largestPx =
            static_cast<float>(std::clamp(grown, double(stage.pass.minPx), double(stage.pass.maxPx)));
    }
    grow = std::max(grow, 0.5 * size.largestPx);
    reach = std::max(reach, forward);
    const double behind = tolerance(stage, run, viewpoint, depths.farthest, size.largestPx);
    const auto order = static_cast<float>((front - forward - behind) * 0.9999998);
    size.frontOrder = order > 0 ? std::bit_cast<std::int32_t>(order) : 0;
    return size;
}

SplatStage makeStage(SplatStage::Kind kind, const Splat& splat, const Sight& sight) {
    const Viewpoint& viewpoint = *sight.viewpoint;
    SplatStage stage;
    stage.kind = kind;
    stage.splat = splat;
    SplatPass& pass = stage.pass;
    pass.shape = splatShape(splat.footprint, splat.profile);
    pass.perspective = viewpoint.projection == Projection::Perspective;
    pass.centerX = static_cast<float>(viewpoint.width * 0.5 + sight.pad);
    pass.centerY = static_cast<float>(viewpoint.height * 0.5 + sight.pad);
    pass.near = std::max(static_cast<float>(viewpoint.near), FLT_MIN);
    pass.far = std::min(static_cast<float>(viewpoint.far), farthestDepth);
    // A size of nothing would divide by nothing; the centre's pixel is drawn anyway.
    const auto bounded = [](float px) { return px > 1e-3f ? std::min(px, 16384.0f) : 1e-3f; };
    if (splat.footprint == Footprint::Pixel) {
        pass.minPx = pass.maxPx = 1;
    } else if (splat.size.sizePx > 0) {
        pass.minPx = pass.maxPx = bounded(splat.size.sizePx);
    } else {
        pass.minPx = bounded(splat.size.minPx);
        pass.maxPx = std::max(bounded(splat.size.maxPx), pass.minPx);
    }
    pass.radiusPerPixel = static_cast<float>(std::min(1 / viewpoint.pixelsPerUnit, 1e30));
    pass.gain = splat.profile == Profile::Flat || !(splat.gain > 0) ? 0.0f : std::min(splat.gain, 1000.0f);
    pass.pixelsPerUnit = static_cast<float>(std::min(viewpoint.pixelsPerUnit, largestCoefficient));
    pass.scale = splat.size.scale;
    if (splat.footprint == Footprint::Ellipse) pass.lowPassPx = splat.lowPassPx;
    pass.oriented = sight.oriented;
    if (sight.oriented)
        pass.facing = splat.facing == Facing::Front ? 1 : splat.facing == Facing::Back ? -1 : 0;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) pass.rotation[r][c] = static_cast<float>(viewpoint.cloudToView[c][r]);
    }
    const bool fixed = splat.footprint == Footprint::Pixel || (!ofSurfels(splat) && splat.size.sizePx > 0);
    if (sight.surfels && !fixed) pass.radii = surfelRadii().data();
    return stage;
}

}  // namespace

std::vector<SplatStage> splatStages(const PassPlan& plan, const Sight& sight) {
    using enum SplatStage::Kind;
    std::vector<SplatStage> stages;
    // Without a known front there is no back to make a silhouette of.
    if (plan.silhouette && sight.oriented) stages.push_back(makeStage(Silhouette, *plan.silhouette, sight));
    stages.push_back(makeStage(Nearest, plan.nearest, sight));
    stages.back().pass.payloadSample = plan.nearest.payload == Payload::Sample;
    if (plan.sum) {
        stages.push_back(makeStage(Sum, *plan.sum, sight));
        SplatPass& pass = stages.back().pass;
        pass.reduction = Reduction::Sum;
        pass.sumNormals = plan.sum->normals;
        if (plan.sum->footprint == Footprint::Disc) {
            pass.reach = plan.sum->reach;
            pass.tolerance = plan.cell ? plan.cell->tolerance : 0.5f;
        }
    }
    if (plan.cell) {
        stages.push_back(makeStage(Cell, *plan.cell, sight));
        SplatPass& pass = stages.back().pass;
        pass.reduction = Reduction::Cell;
        pass.payloadSample = true;
        pass.tolerance = plan.cell->tolerance;
    }
    return stages;
}

std::optional<PreparedRun> prepareRun(const CutRun& cutRun, const Sight& sight,
                                      std::span<const SplatStage> stages, const ColorRule& color,
                                      const SampleFilter& filter, const Rect& area, double maxJitter) {
    const Node& node = *cutRun.node;
    const Viewpoint& viewpoint = *sight.viewpoint;
    if (cutRun.samples.empty() || area.empty()) return std::nullopt;
    const SplatPass& pass = stages.front().pass;
    const Depths depths = depthsOf(node, viewpoint);
    if (!(depths.farthest + depths.error >= pass.near) || !(depths.nearest - depths.error <= pass.far)) {
        return std::nullopt;
    }
    PreparedRun out;
    SplatRun& run = out.run;
    if (!setToPicture(viewRows(node, viewpoint), viewpoint.pixelsPerUnit, run)) return std::nullopt;
    if (!setClip(node, filter, run) || !setDropped(node, filter, out)) return std::nullopt;
    setColor(cutRun, color, pass, run);
    setRadii(cutRun, pass.radii != nullptr, run);
    run.samples = reinterpret_cast<const SampleWords*>(cutRun.samples.data());
    run.count = static_cast<std::uint32_t>(cutRun.samples.size());
    if (!cutRun.limits.empty()) run.limits = reinterpret_cast<const BlockLimits*>(cutRun.limits.data());
    run.firstOrdinal = cutRun.firstOrdinal;
    run.turnStep = turnStep;
    run.turnBase = 0u - cutRun.firstOrdinal * turnStep;
    run.lastTurn = lastTurn(cutRun.share);

    const double front = std::max(depths.nearest - depths.error, static_cast<double>(pass.near));
    double grow = 0, reach = 0;
    for (std::size_t i = 0; i < stages.size(); ++i) {
        out.sizes[i] = sizeIn(stages[i], run, viewpoint, depths, front, grow, reach);
    }
    out.front = static_cast<float>((front - reach) * 0.9999998);
    if (pass.perspective && depths.nearest - depths.error - reach < pass.near) {
        out.bounds = area;  // reaches behind the eye: its corners say nothing
    } else {
        out.bounds = boundsOf(node, viewpoint, sight.pad, grow + maxJitter + 1.5).intersect(area);
    }
    if (out.bounds.empty()) return std::nullopt;
    for (std::size_t i = 0; i < stages.size(); ++i) {
        out.work += run.count * cyclesPerSample(stages[i], std::min(out.sizes[i].largestPx, 64.0f));
    }
    return out;
}

}  // namespace scancast::cpu
