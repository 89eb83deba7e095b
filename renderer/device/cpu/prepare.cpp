#include "renderer/device/cpu/prepare.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <glm/geometric.hpp>

#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/device/host/splats.hpp"

namespace scancast::cpu {
namespace {

static_assert(sizeof(Sample) == sizeof(SampleWords));
static_assert(sizeof(SampleLimits) == sizeof(BlockLimits) && samplesPerLimits == limitsStep);

/// False: shapes, or mirrors, leave nothing of the node.
bool setRegions(const Node& node, const SampleFilter& filter, PreparedRun& out) {
    auto crossing = runRegions(node, filter);
    if (!crossing) return false;
    if (crossing->regions.empty()) return true;
    out.regions = std::make_shared<const std::vector<RunRegion>>(std::move(crossing->regions));
    out.run.regions = out.regions->data();
    out.run.droppedCount = crossing->dropped;
    out.run.keptCount = crossing->kept;
    return true;
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
double cyclesPerSample(const SplatPass& pass, float largestPx) {
    if (largestPx <= 1 && !ofSurfels(pass)) return 10;
    const double rows = std::ceil(largestPx);
    const double chunks = std::ceil(rows / 8);
    const Shape shape = pass.shape;
    const bool roots =
        shape == Shape::ConeCircle || shape == Shape::ConeSquare || shape == Shape::SphereCircle;
    double perChunk = roots ? 10 : 6;
    if (ofSurfels(pass)) perChunk = 20;
    if (pass.reduction == Reduction::Sum) perChunk += 30;
    return (ofSurfels(pass) ? 60 : 25) + rows * chunks * perChunk;
}

void setLargestRatio(const CutRun& cutRun, SplatRun& run) {
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

Extent surfelExtent(const SplatPass& pass, const SplatRun& run, const Viewpoint& viewpoint, double front) {
    const bool ellipse = pass.shape == Shape::Ellipse;
    double radius = double(run.plainRadius) * run.largestRatio * pass.scale;
    if (ellipse) radius *= majorPerRadius;
    radius *= std::max(1.0f, pass.reach);
    // Off the axis a disc appears larger by as much as its ray is longer.
    const double slope = 0.5 * std::hypot(viewpoint.width, viewpoint.height) / viewpoint.pixelsPerUnit;
    const bool perspective = viewpoint.projection == Projection::Perspective;
    const double stretch = perspective ? 1.5 * std::sqrt(1 + slope * slope) : 1.0;
    const double nearest = perspective ? front - radius : 1.0;
    double px = nearest > 0 ? stretch * radius * viewpoint.pixelsPerUnit / nearest : DBL_MAX;
    px = std::min(px, stretch * stretch * pass.maxPx);
    // dz, with |n_xy/n_z| at its bound of 8.
    const double blur = 2.5 * 8 * pass.lowPassPx / viewpoint.q(front);
    return {px + 2.5 * pass.lowPassPx + 0.5, radius + blur};
}

/// How far behind the visible surface a fragment of the run may lie and still be drawn by the pass.
double tolerance(const SplatPass& pass, const SplatRun& run, const Viewpoint& viewpoint, double farthest,
                 double largestPx) {
    if (pass.reduction == Reduction::Nearest) return 0;
    const double pixel = 1 / viewpoint.q(farthest);
    const double radius = double(run.plainRadius) * run.largestRatio * pass.scale;
    switch (pass.shape) {
        case Shape::Ellipse: {
            // 2a + 2dz, with |n_xy/n_z| at its bound of 8.
            const double a = radius * majorPerRadius;
            return 2 * a + 2 * (1.5 * a + 2.5 * 8 * pass.lowPassPx * pixel);
        }
        case Shape::Disc:
            return radius * pass.tolerance;
        default:
            return 2 * (0.5 * largestPx) * pixel;
    }
}

/// Sizes in one pass; grows `grow` (px) and `reach` (cloud units) to what its splats need.
PassSize sizeIn(const SplatPass& pass, const SplatRun& run, const Viewpoint& viewpoint, const Depths& depths,
                double front, double& grow, double& reach) {
    PassSize size;
    double forward = 0;
    if (ofSurfels(pass)) {
        const Extent extent = surfelExtent(pass, run, viewpoint, front);
        size.largestPx = static_cast<float>(std::min(2 * extent.px, 1e6));
        forward = extent.radius;
    } else {
        const double factor = spriteFactor(run.plainRadius, pass.scale, viewpoint.pixelsPerUnit);
        size.sizeFactor = static_cast<float>(std::clamp(factor, 0.0, 1e30));
        const bool perspective = viewpoint.projection == Projection::Perspective;
        const double grown = 1.000001 * factor * run.largestRatio / (perspective ? front : 1.0);
        size.largestPx = static_cast<float>(std::clamp(grown, double(pass.minPx), double(pass.maxPx)));
    }
    grow = std::max(grow, 0.5 * size.largestPx);
    reach = std::max(reach, forward);
    const double behind = tolerance(pass, run, viewpoint, depths.farthest, size.largestPx);
    const auto order = static_cast<float>((front - forward - behind) * 0.9999998);
    size.frontOrder = order > 0 ? std::bit_cast<std::int32_t>(order) : 0;
    return size;
}

}  // namespace

std::optional<PreparedRun> prepareRun(const CutRun& cutRun, const LayerView& layerView,
                                      std::span<const SplatPass> passes, const ColorRule& color,
                                      const SampleFilter& filter, const Rect& area, double maxJitter) {
    const Node& node = *cutRun.node;
    const Viewpoint& viewpoint = *layerView.viewpoint;
    if (cutRun.samples.empty() || area.empty()) return std::nullopt;
    const SplatPass& pass = passes.front();
    const Depths depths = depthsOf(node, viewpoint);
    if (!(depths.farthest + depths.error >= pass.near) || !(depths.nearest - depths.error <= pass.far)) {
        return std::nullopt;
    }
    const auto numbers = runNumbers(cutRun, layerView, color, filter);
    if (!numbers) return std::nullopt;
    PreparedRun out;
    SplatRun& run = out.run;
    static_cast<RunNumbers&>(run) = *numbers;
    if (!setRegions(node, filter, out)) return std::nullopt;
    if (pass.ownRadii) setLargestRatio(cutRun, run);
    run.samples = reinterpret_cast<const SampleWords*>(cutRun.samples.data());
    run.count = static_cast<std::uint32_t>(cutRun.samples.size());
    if (!cutRun.beside.empty()) run.beside = cutRun.beside.data();
    if (!cutRun.limits.empty()) run.limits = reinterpret_cast<const BlockLimits*>(cutRun.limits.data());

    const double front = std::max(depths.nearest - depths.error, static_cast<double>(pass.near));
    double grow = 0, reach = 0;
    for (std::size_t i = 0; i < passes.size(); ++i) {
        out.sizes[i] = sizeIn(passes[i], run, viewpoint, depths, front, grow, reach);
    }
    out.front = static_cast<float>((front - reach) * 0.9999998);
    if (pass.perspective && depths.nearest - depths.error - reach < pass.near) {
        out.bounds = area;  // reaches behind the eye: its corners say nothing
    } else {
        out.bounds = boundsOf(node, viewpoint, layerView.pad, grow + maxJitter + 1.5).intersect(area);
    }
    if (out.bounds.empty()) return std::nullopt;
    for (std::size_t i = 0; i < passes.size(); ++i) {
        out.work += run.count * cyclesPerSample(passes[i], std::min(out.sizes[i].largestPx, 64.0f));
    }
    return out;
}

}  // namespace scancast::cpu
