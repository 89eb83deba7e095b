#include "renderer/mirrors.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace scancast {

namespace {

/// A mirror's glass wins against the scene where it lies at most so many point spacings behind it.
constexpr double marginInSpacings = 2;

/// Cloud-relative; w is the distance to the origin, so that points before the mirror are positive.
glm::dvec4 planeOf(const Mirror& mirror, const glm::dvec3& cloudOrigin) {
    return {mirror.normal, -glm::dot(mirror.normal, mirror.center - cloudOrigin)};
}

Region behind(const Mirror& mirror, const glm::dvec3& cloudOrigin) {
    const glm::dvec3 center = mirror.center - cloudOrigin;
    const glm::dvec3 right = glm::cross(mirror.up, mirror.normal);
    Region region;
    const auto add = [&](const glm::dvec3& inwards, const glm::dvec3& through) {
        const glm::dvec3 n = glm::normalize(inwards);
        region.planes[static_cast<std::size_t>(region.count++)] = {n, -glm::dot(n, through)};
    };
    add(-mirror.normal, center);
    for (const double side : {1.0, -1.0}) {
        add(-side * right - mirror.normal, center + right * (side * mirror.width / 2));
        add(-side * mirror.up - mirror.normal, center + mirror.up * (side * mirror.height / 2));
    }
    return region;
}

using Polygon = std::vector<glm::dvec3>;

/// What of a convex polygon lies where value(corner) ≥ 0, which is linear.
template <class Value>
Polygon clipped(const Polygon& polygon, const Value& value) {
    Polygon out;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
        const double a = value(from), b = value(to);
        if (a >= 0) out.push_back(from);
        if ((a >= 0) != (b >= 0)) out.push_back(from + (to - from) * (a / (a - b)));
    }
    return out;
}

/// Pixels that the rectangle may cover in a picture moved by less than a pixel, and `margin` px around it;
/// nothing where none.
std::optional<Window> boundsOf(const MirrorGlass& m, const Viewpoint& viewpoint, int margin) {
    Polygon corners{m.center - m.right - m.up, m.center + m.right - m.up, m.center + m.right + m.up,
                    m.center - m.right + m.up};
    corners = clipped(corners, [&](const glm::dvec3& p) { return -p.z - viewpoint.near; });
    if (std::isfinite(viewpoint.far))
        corners = clipped(corners, [&](const glm::dvec3& p) { return viewpoint.far + p.z; });
    for (glm::dvec3& corner : corners) corner = viewpoint.project(corner);
    constexpr double jitter = 1;
    const double around = margin + jitter;
    corners = clipped(corners, [&](const glm::dvec3& p) { return p.x + around; });
    corners = clipped(corners, [&](const glm::dvec3& p) { return viewpoint.width + around - p.x; });
    corners = clipped(corners, [&](const glm::dvec3& p) { return p.y + around; });
    corners = clipped(corners, [&](const glm::dvec3& p) { return viewpoint.height + around - p.y; });
    if (corners.size() < 3) return std::nullopt;
    glm::dvec3 low = corners[0], high = corners[0];
    for (const glm::dvec3& corner : corners) {
        low = glm::min(low, corner);
        high = glm::max(high, corner);
    }
    const int x0 = std::max(-margin, static_cast<int>(std::floor(low.x - jitter)));
    const int y0 = std::max(-margin, static_cast<int>(std::floor(low.y - jitter)));
    const int x1 = std::min(viewpoint.width + margin, static_cast<int>(std::ceil(high.x + jitter)));
    const int y1 = std::min(viewpoint.height + margin, static_cast<int>(std::ceil(high.y + jitter)));
    const bool seen =
        x0 < std::min(x1, viewpoint.width) && y0 < std::min(y1, viewpoint.height) && x1 > 0 && y1 > 0;
    if (!seen) return std::nullopt;
    return Window{x0, y0, x1 - x0, y1 - y0};
}

/// Without its bounds.
MirrorGlass glassOf(const Mirror& mirror, const Cloud& cloud, const Viewpoint& viewpoint) {
    const glm::dmat3 rotation(viewpoint.cloudToView);
    MirrorGlass m;
    m.center = viewpoint.cloudToView * glm::dvec4(mirror.center - cloud.origin, 1);
    m.normal = rotation * mirror.normal;
    m.right = rotation * glm::cross(mirror.up, mirror.normal) * (mirror.width / 2);
    m.up = rotation * mirror.up * (mirror.height / 2);
    m.tint = mirror.tint;
    m.margin = marginInSpacings * cloud.spacing;
    return m;
}

/// Whether the eye is on the reflecting side.
bool facesTheEye(const MirrorGlass& m, Projection projection) {
    return projection == Projection::Perspective ? glm::dot(m.normal, m.center) < 0 : m.normal.z > 0;
}

}  // namespace

std::vector<Region> behindMirrors(const Cloud& cloud) {
    std::vector<Region> regions;
    for (const Mirror& mirror : cloud.mirrors) regions.push_back(behind(mirror, cloud.origin));
    return regions;
}

Viewpoint reflected(const Viewpoint& viewpoint, const Mirror& mirror, const glm::dvec3& cloudOrigin) {
    const glm::dvec4 plane = planeOf(mirror, cloudOrigin);
    const glm::dvec3 n(plane);
    glm::dmat4 reflect(1);
    for (int column = 0; column < 3; ++column) reflect[column] -= glm::dvec4(2 * n[column] * n, 0);
    reflect[3] = glm::dvec4(-2 * plane.w * n, 1);
    Viewpoint v = viewpoint;
    v.cloudToView = viewpoint.cloudToView * reflect;
    return v;
}

std::vector<CutView> reflectionsIn(const Cloud& cloud, const Viewpoint& viewpoint, const SampleFilter& filter,
                                   int marginPx) {
    std::vector<CutView> reflections;
    for (const Mirror& mirror : cloud.mirrors) {
        MirrorGlass glass = glassOf(mirror, cloud, viewpoint);
        if (!facesTheEye(glass, viewpoint.projection)) continue;
        const auto bounds = boundsOf(glass, viewpoint, marginPx);
        if (!bounds) continue;
        glass.bounds = *bounds;
        CutView& view = reflections.emplace_back();
        view.viewpoint = reflected(viewpoint, mirror, cloud.origin);
        view.filter = filter;
        view.filter.dropped.push_back({{-planeOf(mirror, cloud.origin)}, 1});
        view.glass = glass;
    }
    return reflections;
}

SelectOptions selectionOf(const CutView& view, SelectOptions pictures) {
    if (!view.glass) return pictures;
    const Window& b = view.glass->bounds;
    pictures.part = {{double(b.x), double(b.y), double(b.x + b.width), double(b.y + b.height)}};
    // The last region dropped is what lies behind the mirror.
    pictures.inFrontOf.push_back(-view.filter.dropped.back().planes[0]);
    return pictures;
}

std::vector<std::uint64_t> shareBudget(std::uint64_t budget, std::span<const CutView> cuts) {
    std::vector<double> areas;
    for (const CutView& view : cuts) {
        areas.push_back(view.glass ? double(view.glass->bounds.width) * view.glass->bounds.height
                                   : double(view.viewpoint.width) * view.viewpoint.height);
    }
    double all = 0;
    for (const double area : areas) all += area;
    std::vector<std::uint64_t> shares;
    for (const double area : areas)
        shares.push_back(std::max<std::uint64_t>(1, std::uint64_t(double(budget) * (area / all))));
    return shares;
}

}  // namespace scancast
