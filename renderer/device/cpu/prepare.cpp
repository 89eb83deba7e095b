#include "renderer/device/cpu/prepare.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>

#include "renderer/device/splat_plan.hpp"

namespace scancast::cpu {
namespace {

static_assert(sizeof(Sample) == sizeof(SampleWords));

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
Rect boundsOf(const Node& node, const Viewpoint& viewpoint, double grow) {
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
    return {pixel(std::floor(viewpoint.width * 0.5 + x0 - grow)),
            pixel(std::floor(viewpoint.height * 0.5 + y0 - grow)),
            pixel(std::ceil(viewpoint.width * 0.5 + x1 + grow)),
            pixel(std::ceil(viewpoint.height * 0.5 + y1 + grow))};
}

/// Cycles a sample costs, roughly: what tiles are balanced by.
double cyclesPerSample(const SplatPass& pass, float largestPx) {
    if (largestPx <= 1) return 10;
    const double rows = std::ceil(largestPx);
    const double chunks = std::ceil(rows / 8);
    const bool roots = pass.shape == Shape::ConeCircle || pass.shape == Shape::ConeSquare ||
                       pass.shape == Shape::SphereCircle;
    return 25 + rows * chunks * (roots ? 10 : 6);
}

}  // namespace

SplatPass preparePass(const Viewpoint& viewpoint, const NearestPass& nearest) {
    SplatPass pass;
    pass.shape = splatShape(nearest.footprint, nearest.profile);
    pass.perspective = viewpoint.projection == Projection::Perspective;
    pass.centerX = static_cast<float>(viewpoint.width * 0.5);
    pass.centerY = static_cast<float>(viewpoint.height * 0.5);
    pass.near = std::max(static_cast<float>(viewpoint.near), FLT_MIN);
    pass.far = std::min(static_cast<float>(viewpoint.far), farthestDepth);
    // A size of nothing would divide by nothing; the centre's pixel is drawn anyway.
    const auto bounded = [](float px) { return px > 1e-3f ? std::min(px, 16384.0f) : 1e-3f; };
    if (nearest.footprint == Footprint::Pixel) {
        pass.minPx = pass.maxPx = 1;
    } else if (nearest.size.sizePx > 0) {
        pass.minPx = pass.maxPx = bounded(nearest.size.sizePx);
    } else {
        pass.minPx = bounded(nearest.size.minPx);
        pass.maxPx = std::max(bounded(nearest.size.maxPx), pass.minPx);
    }
    pass.radiusPerPixel = static_cast<float>(std::min(1 / viewpoint.pixelsPerUnit, 1e30));
    pass.gain =
        nearest.profile == Profile::Flat || !(nearest.gain > 0) ? 0.0f : std::min(nearest.gain, 1000.0f);
    return pass;
}

std::optional<PreparedRun> prepareRun(const CutRun& cutRun, const Viewpoint& viewpoint,
                                      const NearestPass& nearest, const SplatPass& pass,
                                      const ColorRule& color, const SampleFilter& filter, const Rect& area,
                                      double maxJitter) {
    const Node& node = *cutRun.node;
    if (cutRun.samples.empty() || area.empty()) return std::nullopt;
    const Depths depths = depthsOf(node, viewpoint);
    if (!(depths.farthest + depths.error >= pass.near) || !(depths.nearest - depths.error <= pass.far)) {
        return std::nullopt;
    }
    PreparedRun out;
    SplatRun& run = out.run;
    if (!setToPicture(viewRows(node, viewpoint), viewpoint.pixelsPerUnit, run)) return std::nullopt;
    if (!setClip(node, filter, run)) return std::nullopt;
    setColor(cutRun, color, pass, run);
    run.samples = reinterpret_cast<const SampleWords*>(cutRun.samples.data());
    run.count = static_cast<std::uint32_t>(cutRun.samples.size());

    const double front = std::max(depths.nearest - depths.error, static_cast<double>(pass.near));
    // pass.pixelsPerUnit is f in perspective and q in orthographic projection: p = factor (/ d).
    const double factor = 2.0 * node.spacing * nearest.size.scale * viewpoint.pixelsPerUnit;
    run.sizeFactor = static_cast<float>(std::clamp(factor, 0.0, 1e30));
    const double grown = 1.000001 * factor / (pass.perspective ? front : 1.0);
    run.largestPx = static_cast<float>(
        std::clamp(grown, static_cast<double>(pass.minPx), static_cast<double>(pass.maxPx)));

    out.nearestOrder = std::bit_cast<std::int32_t>(static_cast<float>(front * 0.9999998));
    if (pass.perspective && depths.nearest - depths.error < pass.near) {
        out.bounds = area;  // reaches behind the eye: its corners say nothing
    } else {
        out.bounds = boundsOf(node, viewpoint, run.largestPx * 0.5 + maxJitter + 1.5).intersect(area);
    }
    if (out.bounds.empty()) return std::nullopt;
    out.work = run.count * cyclesPerSample(pass, run.largestPx);
    return out;
}

}  // namespace scancast::cpu
