#include "simulator/materials.hpp"

#include <algorithm>

#include "simulator/scenes/glyphs.hpp"

namespace scancast {

void PlainMaterial::apply(const Patch&, SurfacePoint& point) const {
    const glm::vec2 at(float(point.s) / options_.variationSize + float(point.position.x) * 0.1F,
                       float(point.t) / options_.variationSize + float(point.position.y) * 0.1F);
    const float cloud = smoothNoise(at, options_.salt) - 0.5F, grain = point.random->unit() - 0.5F;
    point.color = options_.color * (1 + options_.variation * (1.4F * cloud + 0.6F * grain));
    point.reflectance = options_.reflectance;
    point.classification = options_.classification;
}

void StripedMaterial::apply(const Patch&, SurfacePoint& point) const {
    const bool first = (int(std::floor(point.s / options_.width)) & 1) == 0;
    point.color = (first ? options_.first : options_.second) * point.random->range(0.97F, 1.03F);
    point.reflectance = options_.reflectance;
    point.classification = options_.classification;
}

void SignMaterial::apply(const Patch& patch, SurfacePoint& point) const {
    point.classification = options_.classification;
    point.reflectance = options_.reflectance;
    point.color = options_.board * (0.94F + 0.06F * float(point.t / patch.lengthV));
    const double edge =
        std::min(std::min(point.s, patch.lengthU - point.s), std::min(point.t, patch.lengthV - point.t));
    if (edge < options_.rimWidth) {
        point.color = options_.rim;
        return;
    }
    for (const Line& line : options_.lines) {
        const double left = (patch.lengthU - textWidth(line.text) * line.height) / 2;
        const double y = (point.t - line.foot) / line.height;
        if (!textInk(line.text, (point.s - left) / line.height, y, line.boldness)) continue;
        point.color = line.color;
        point.reflectance = options_.inkReflectance;
        return;
    }
}

}  // namespace scancast
