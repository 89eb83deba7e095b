#include "renderer/device/host/screens.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "renderer/device/host/colors.hpp"

namespace scancast {
namespace {

// ---- the pyramid

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

// ---- glass

/// Value at the picture's pixel (0, 0), and steps.
void setLinear(double atZero, double stepX, double stepY, float out[3]) {
    out[0] = static_cast<float>(atZero);
    out[1] = static_cast<float>(stepX);
    out[2] = static_cast<float>(stepY);
}

/// Where the ray of a pixel meets the mirror's plane. In perspective the ray is d · r, r = (u, v, -1), with
/// normal · (d r - center) = 0: so 1/d = normal · r / normal · center, linear in the pixel, and the place
/// right · (d r - center) / right² is linear, too, once divided by d. Else the ray is r = (u, v, 0) with
/// -d in the place of z.
void setPlane(const MirrorGlass& m, double unit, const glm::dvec2& axis, GlassNumbers& g) {
    // r at the picture's pixel (0, 0): at its centre.
    const glm::dvec3 r((0.5 - axis.x) * unit, (axis.y - 0.5) * unit, 0);
    double at = 0, stepX = 0, stepY = 0;
    if (g.perspective) {
        const double scale = 1 / glm::dot(m.normal, m.center);
        at = (m.normal.x * r.x + m.normal.y * r.y - m.normal.z) * scale;
        stepX = m.normal.x * unit * scale;
        stepY = -m.normal.y * unit * scale;
    } else {
        at = (m.normal.x * r.x + m.normal.y * r.y - glm::dot(m.normal, m.center)) / m.normal.z;
        stepX = m.normal.x * unit / m.normal.z;
        stepY = -m.normal.y * unit / m.normal.z;
    }
    setLinear(at, stepX, stepY, g.depthAt);
    const auto place = [&](const glm::dvec3& half, float out[3]) {
        const glm::dvec3 h = half / glm::dot(half, half);
        const double center = glm::dot(h, m.center);
        const double along = h.x * r.x + h.y * r.y;
        if (g.perspective) {
            setLinear(along - h.z - center * at, h.x * unit - center * stepX, -h.y * unit - center * stepY,
                      out);
        } else {
            setLinear(along - h.z * at - center, h.x * unit - h.z * stepX, -h.y * unit - h.z * stepY, out);
        }
    };
    place(m.right, g.rightAt);
    place(m.up, g.upAt);
}

}  // namespace

// ---- lighting

PhongNumbers phongNumbers(const PhongPass& pass, const LayerView& view, const glm::dvec2& jitter, int x,
                          int y) {
    const glm::dvec2 axis = view.center() + jitter;
    PhongNumbers n;
    n.perspective = view.perspective();
    n.x = x;
    n.y = y;
    n.offsetX = static_cast<float>(0.5 - axis.x);
    n.offsetY = static_cast<float>(0.5 - axis.y);
    n.inverseFocal = static_cast<float>(std::min(1 / view.viewpoint->pixelsPerUnit, 1e30));
    n.ambient = pass.ambient;
    n.headlight = pass.headlight;
    n.sunlight = pass.sunlight;
    n.shine = pass.shine;
    const glm::dvec3 sun =
        glm::dmat3(view.viewpoint->cloudToView) * glm::dvec3(pass.sun[0], pass.sun[1], pass.sun[2]);
    for (int i = 0; i < 3; ++i) n.sun[i] = static_cast<float>(sun[i]);
    return n;
}

EyeDomeNumbers eyeDomeNumbers(const EyeDomePass& pass) {
    const double radius = std::clamp(pass.radiusPx, 0.0f, 64.0f);
    EyeDomeNumbers n;
    n.reach = static_cast<std::int32_t>(std::ceil(radius));
    for (int k = 0; k < 8; ++k) {
        const double angle = k * 0.785398163397448309616;
        n.x[k] = static_cast<std::int32_t>(std::lround(radius * std::cos(angle)));
        n.y[k] = static_cast<std::int32_t>(std::lround(radius * std::sin(angle)));
    }
    constexpr double log2e = 1.44269504088896340736;
    n.factor = static_cast<float>(300.0 * std::clamp(pass.strength, 0.0f, 1000.0f) / 8 * log2e);
    return n;
}

int occlusionReach(const OcclusionPass& pass) {
    return std::max(
        1, static_cast<int>(std::ceil(1.2 * std::clamp(double(pass.radiusPx), 0.0, widestOcclusion))));
}

OcclusionNumbers occlusionNumbers(const OcclusionPass& pass, const LayerView& view,
                                  const glm::dvec2& jitter) {
    constexpr double eighth = 0.785398163397448309616, golden = 0.618033988749894848;
    constexpr double narrower = 0.6, darkest = 4;
    OcclusionNumbers n;
    n.perspective = view.perspective();
    n.reach = occlusionReach(pass);
    double radius =
        std::clamp(double(pass.radiusPx), 0.0, widestOcclusion) * (1 + 0.4 * std::clamp(jitter.y, -0.5, 0.5));
    for (int ring = 0; ring < occlusionRings; ++ring, radius *= narrower) {
        for (int line = 0; line < linesPerRing; ++line) {
            const double angle = eighth * (line + golden * ring + std::clamp(jitter.x, -0.5, 0.5));
            const int k = ring * linesPerRing + line;
            n.x[k] = static_cast<std::int32_t>(std::lround(radius * std::cos(angle)));
            n.y[k] = static_cast<std::int32_t>(std::lround(radius * std::sin(angle)));
            if (n.x[k] == 0 && n.y[k] == 0) n.x[k] = 1;  // nobody is his own neighbour
            n.perPx[k] = static_cast<float>(view.viewpoint->pixelsPerUnit / std::hypot(n.x[k], n.y[k]));
        }
    }
    n.factor = static_cast<float>(darkest * std::clamp(pass.strength, 0.0f, 1.0f) / occlusionPairs);
    return n;
}

ShadowNumbers shadowNumbers(const ShadowPass& pass, const LayerView& view, const Viewpoint& sun,
                            const glm::dvec2& jitter, int x, int y) {
    const Viewpoint& eye = *view.viewpoint;
    const glm::dvec2 axis = view.center() + jitter;
    const glm::dmat4 rows = glm::transpose(sun.cloudToView * glm::inverse(eye.cloudToView));
    const double unit = 1 / eye.pixelsPerUnit;
    ShadowNumbers n;
    n.perspective = view.perspective();
    n.x = x;
    n.y = y;
    n.mapWidth = sun.width;
    n.mapHeight = sun.height;
    n.strength = std::clamp(pass.strength, 0.0f, 1.0f);
    n.share = std::clamp(pass.share, 0.0f, 1.0f);
    n.bias = pass.bias;
    // dot(row, point) with the point of a pixel and a depth put in: (x · unit, y · unit, -1) · d, or · 1 but for z.
    const auto setTo = [&](const glm::dvec4& row, float* out) {
        const double flat = (row.x * (0.5 - axis.x) + row.y * (axis.y - 0.5)) * unit;
        out[0] = static_cast<float>(flat + (n.perspective ? -row.z : row.w));
        out[1] = static_cast<float>(row.x * unit);
        out[2] = static_cast<float>(-row.y * unit);
        out[3] = static_cast<float>(n.perspective ? row.w : -row.z);
    };
    const double q = sun.pixelsPerUnit;
    setTo(q * rows[0] + glm::dvec4(0, 0, 0, sun.width * 0.5), n.u);
    setTo(-q * rows[1] + glm::dvec4(0, 0, 0, sun.height * 0.5), n.v);
    setTo(-rows[2], n.depth);
    return n;
}

// ---- the pyramid

PyramidView pyramidView(const LayerView& layer, const glm::dvec2& jitter, int x, int y, int width,
                        int height) {
    PyramidView view;
    view.width = width;
    view.height = height;
    view.perspective = layer.perspective();
    view.pixelsPerUnit = layer.viewpoint->pixelsPerUnit;
    view.center = layer.center() + jitter - glm::dvec2(x, y);
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
    const Size size =
        pass.fixedPx > 0 ? Size{0, pass.fixedPx} : sizeOf(view, pass.scale, pass.spacing, pass.detail);
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
    // Whoever hides nothing closes nothing.
    const Size closing = sizeOf(view, pass.threshold > 0 ? 8 * pass.closing : 0, pass.spacing, pass.detail);
    n.closing = {static_cast<float>(std::min(closing.scaled, 1e15)),
                 static_cast<float>(std::min(closing.least, double(ClosingSize::most)))};
    n.perspective = view.perspective;
    return n;
}

std::int32_t HiddenPointsNumbers::closingAt(float depth) const {
    const float size = perspective ? closing.scaled / std::max(depth, ClosingSize::nearest) : closing.scaled;
    return static_cast<std::int32_t>(std::min(std::max(size, closing.least), ClosingSize::most));
}

VisibilityColors visibilityColors(const VisibilityPass& pass) {
    constexpr std::uint32_t opaque = 0xff000000u;
    return {packed(pass.foreground) | opaque, packed(pass.hidden) | opaque, packed(pass.hole) | opaque};
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

// ---- glass

GlassNumbers glassNumbers(const MirrorGlass& glass, const LayerView& view, const glm::dvec2& jitter) {
    GlassNumbers g;
    g.perspective = view.perspective();
    setPlane(glass, 1 / view.viewpoint->pixelsPerUnit, view.center() + jitter, g);
    g.margin = static_cast<float>(glass.margin);
    for (std::size_t c = 0; c < 3; ++c) g.tint[c] = glass.tint[c];
    return g;
}

}  // namespace scancast
