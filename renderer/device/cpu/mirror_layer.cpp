#include "renderer/device/cpu/mirror_layer.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

#include "renderer/device/cpu/grown.hpp"

namespace scancast::cpu {
namespace {

Rect areaOf(const Reflection& reflection, int pad, const Rect& picture) {
    const Window& b = reflection.bounds;
    return Rect{b.x + pad, b.y + pad, b.x + b.width + pad, b.y + b.height + pad}.intersect(picture);
}

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
void setPlane(const Reflection& m, const Viewpoint& viewpoint, const glm::dvec2& axis, Glass& g) {
    const double unit = 1 / viewpoint.pixelsPerUnit;
    // r at the picture's pixel (0, 0): at its centre.
    const glm::dvec3 r((0.5 - axis.x) * unit, (axis.y - 0.5) * unit, 0);
    g.perspective = viewpoint.projection == Projection::Perspective;
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

MirrorLayer::MirrorLayer(const Drawing& drawing, const Reflection& reflection, const Sight& picturesSight,
                         const PassPlan& plan, const Kernels& kernels, const Workers& workers,
                         TileMemories& tiles, LayerMemory& memory, const Rect& picture)
    : reflection_(reflection),
      sight_{&reflection.viewpoint, picturesSight.pad, picturesSight.surfels, picturesSight.oriented},
      plan_(plan),
      kernels_(kernels),
      workers_(workers),
      memory_(memory),
      area_(areaOf(reflection, picturesSight.pad, picture)) {
    if (!empty())
        layer_.emplace(drawing, reflection.cut, reflection.filter, sight_, plan, kernels, workers, tiles,
                       area_);
}

void MirrorLayer::draw(const glm::dvec2& jitter, const Planes& picture) {
    const std::size_t pixels =
        static_cast<std::size_t>(area_.width()) * static_cast<std::size_t>(area_.height());
    Planes planes;
    planes.area = area_;
    planes.rgba = grown(memory_.rgba, pixels);
    planes.depth = grown(memory_.depth, pixels);
    if (plan_.resolve.normals) planes.normals = grown(memory_.normals, pixels);
    FrameStats own;  // its stages are the picture's one stage "mirrors"
    layer_->draw(jitter, planes, own);
    layOver(jitter, planes, picture, kernels_.lookThrough);
}

void MirrorLayer::finish(const glm::dvec2& jitter, const Planes& picture) const {
    layOver(jitter, {}, picture, kernels_.tintGlass);
}

void MirrorLayer::layOver(const glm::dvec2& jitter, const Planes& reflected, const Planes& picture,
                          Lay lay) const {
    const Viewpoint& viewpoint = reflection_.viewpoint;
    const glm::dvec2 axis(viewpoint.width * 0.5 + sight_.pad, viewpoint.height * 0.5 + sight_.pad);
    Glass whole;
    setPlane(reflection_, viewpoint, axis + jitter, whole);
    whole.margin = static_cast<float>(reflection_.margin);
    whole.stride = picture.area.width();
    whole.reflectedStride = area_.width();
    whole.x = area_.x0;
    whole.width = area_.width();
    for (std::size_t c = 0; c < 3; ++c) whole.tint[c] = reflection_.tint[c];
    workers_.overRows(area_.height(), [&](int y0, int y1) {
        Glass g = whole;
        g.y = area_.y0 + y0;
        g.height = y1 - y0;
        const std::ptrdiff_t at = picture.at(g.x, g.y);
        g.rgba = picture.rgba + at;
        g.depth = picture.depth + at;
        if (reflected.rgba != nullptr) {
            const std::ptrdiff_t from = reflected.at(g.x, g.y);
            g.reflected = reflected.rgba + from;
            g.reflectedDepth = reflected.depth + from;
            if (reflected.normals != nullptr) {
                g.normals = picture.normals + at;
                g.reflectedNormals = reflected.normals + from;
            }
        }
        lay(g);
    });
}

}  // namespace scancast::cpu
