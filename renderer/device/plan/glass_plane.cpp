#include "renderer/device/plan/glass_plane.hpp"

#include <glm/geometric.hpp>

namespace scancast {
namespace {

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

GlassNumbers glassNumbers(const MirrorGlass& glass, const Sight& sight, const glm::dvec2& jitter) {
    GlassNumbers g;
    g.perspective = sight.perspective();
    setPlane(glass, 1 / sight.viewpoint->pixelsPerUnit, sight.center() + jitter, g);
    g.margin = static_cast<float>(glass.margin);
    for (std::size_t c = 0; c < 3; ++c) g.tint[c] = glass.tint[c];
    return g;
}

}  // namespace scancast
