#include "renderer/device/plan/pyramid_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scancast {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr float largest = std::numeric_limits<float>::max();

/// s_eff = max(s0, 2τ/q) (docs/spec/pyramid.md §2), times a factor, as px · depth (orthographic: px) and
/// least px.
struct Size {
    double scaled, least;
};

Size sizeOf(const PyramidView& view, double factor, double spacing, double detail) {
    return {factor * std::max(0.0, spacing) * view.pixelsPerUnit, factor * 2 * std::max(0.0, detail)};
}

/// The largest depth at which scaled / depth is `px` or more; -1 = none.
float farthestDepthOf(double scaled, double px) {
    const double limit = scaled / px;
    if (!(limit >= std::numeric_limits<float>::min())) return -1;
    if (limit >= largest) return largest;
    float depth = static_cast<float>(limit);
    while (!(scaled / depth >= px)) depth = std::nextafter(depth, 0.0f);
    for (float next = depth; scaled / next >= px; next = std::nextafter(next, infinite)) depth = next;
    return depth;
}

/// Neighbours of level l lie at most 2.5 texels away on each axis. Seen from the eye, pixels p px apart
/// differ by at most p/f, and 1 - cos a ≤ a²/2.
int sureLevelOf(const PyramidView& view, double threshold) {
    if (!(threshold > 0)) return -1;
    if (!view.perspective) return maxPyramidLevels;
    int level = -1;
    const auto occlusion = [&](int l) {
        const double angle = 2.5 * std::sqrt(2.0) * std::ldexp(1.0, l) / view.pixelsPerUnit;
        return angle * angle / 2;
    };
    while (level < maxPyramidLevels && occlusion(level + 1) < 0.9 * threshold) ++level;
    return level;
}

/// Of a size in px, among `count` levels.
double levelOf(double px, double slack, int count) {
    return std::clamp(std::log2(std::max(px, 1.0)) + slack, 0.0, count - 1.0);
}

}  // namespace

PyramidView pyramidView(const Sight& sight, const glm::dvec2& jitter, int x, int y, int width, int height) {
    PyramidView view;
    view.width = width;
    view.height = height;
    view.perspective = sight.perspective();
    view.pixelsPerUnit = sight.viewpoint->pixelsPerUnit;
    view.center = sight.center() + jitter - glm::dvec2(x, y);
    return view;
}

Unprojection unprojectionOf(const PyramidView& view) {
    Unprojection u;
    u.perspective = view.perspective;
    u.step = static_cast<float>(1 / view.pixelsPerUnit);
    u.centerX = static_cast<float>(view.center.x);
    u.centerY = static_cast<float>(view.center.y);
    return u;
}

PyramidShape pyramidShape(std::int32_t width, std::int32_t height) {
    PyramidShape shape;
    for (std::size_t k = 0; k < maxPyramidLevels; ++k) {
        shape.width[k] = width;
        shape.height[k] = height;
        shape.levels = static_cast<int>(k) + 1;
        const std::int32_t shorter = std::min(width, height);
        if (shorter >= 4) shape.widest = static_cast<int>(k);
        if (shorter >= 2) shape.normalLevels = static_cast<int>(k) + 1;
        if (width == 1 && height == 1 && k >= blockLevel) break;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    return shape;
}

HiddenPointsNumbers hiddenPointsNumbers(const PyramidView& view, const HiddenPointsPass& pass) {
    const Size size = sizeOf(view, pass.scale, pass.spacing, pass.detail);
    HiddenPointsNumbers n;
    for (int level = 0; level < maxPyramidLevels; ++level) {
        const double px = std::ldexp(1.0, level);
        float& farthest = n.farthest[static_cast<std::size_t>(level)];
        const bool always = size.least >= px || (!view.perspective && size.scaled >= px);
        farthest = always ? infinite : view.perspective ? farthestDepthOf(size.scaled, px) : -1;
    }
    n.minGap = std::max(0.0f, pass.minGap);
    n.threshold = pass.threshold;
    n.sureLevel = sureLevelOf(view, pass.threshold);
    return n;
}

NormalNumbers normalNumbers(const PyramidView& view, const PyramidShape& shape,
                            const DepthNormalsPass& pass) {
    const Size size = sizeOf(view, pass.scale, pass.spacing, pass.detail);
    return {size.scaled, size.least, shape.normalLevels, view.perspective};
}

int NormalNumbers::first() const {
    return static_cast<int>(levelOf(least, -0.01, count));
}

int NormalNumbers::last(float nearest) const {
    const double most = std::max(perspective ? scaled / nearest : scaled, least);
    return static_cast<int>(std::ceil(levelOf(most, 0.01, count)));
}

}  // namespace scancast
