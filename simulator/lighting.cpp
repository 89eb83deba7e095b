#include "simulator/lighting.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {

glm::vec3 lit(const Model& model, const CellTable& cells, const Cell* cell, const Patch& patch,
              const SurfacePoint& point) {
    const Light& light = model.light;
    if (light.kind == Light::Kind::None) return point.color;
    const glm::vec3 at = point.position;
    const glm::vec3 tested =
        patch.lightOffset == glm::dvec3(0) ? at + point.normal * 0.06F : at + glm::vec3(patch.lightOffset);
    glm::vec3 towards = light.towards;
    float reach = 1e9F, strength = 1;
    if (light.kind == Light::Kind::Lamp) {
        const glm::vec3 way = light.towards - tested;
        reach = glm::length(way);
        towards = way / std::max(reach, 1e-3F);
        strength = 1 / (1 + reach * reach / (light.lampReach * light.lampReach));
    }
    float direct = point.sunlit * std::max(0.0F, glm::dot(point.normal, towards));
    if (!patch.hasNormal)
        direct = point.sunlit *
                 (0.35F + 0.65F * std::clamp(0.5F + 0.5F * glm::dot(point.normal, towards), 0.0F, 1.0F));
    const bool shaded = cell && !patch.ownShadows;
    for (int i = 0; shaded && direct > 0 && i < cell->shadowCount; ++i)
        if (model.occluders[cells.occluder(cell->firstOccluder + std::uint32_t(i))].blocks(tested, towards,
                                                                                           reach))
            direct = 0;
    float open = 1;
    for (int i = 0; shaded && i < cell->nearCount; ++i) {
        const Occluder& body =
            model.occluders[cells.occluder(cell->firstOccluder + cell->shadowCount + std::uint32_t(i))];
        for (const float height : {0.35F, 1.1F}) {
            const float gap = body.distance(tested + point.normal * height);
            open *= 1 - 0.38F * std::clamp((height - gap) / height, 0.0F, 1.0F);
        }
    }
    const float up = 0.5F + 0.5F * point.normal.z;
    const glm::vec3 ambient = (light.ground + (light.sky - light.ground) * up) * (open * point.openness);
    const glm::vec3 linear = point.color * point.color *
                             (ambient + light.color * (direct * strength * (0.4F + 0.6F * point.openness)));
    return glm::vec3(std::sqrt(linear.x), std::sqrt(linear.y), std::sqrt(linear.z));
}

}  // namespace scancast
