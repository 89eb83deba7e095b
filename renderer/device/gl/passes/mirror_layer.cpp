#include "renderer/device/gl/passes/mirror_layer.hpp"

#include <algorithm>

#include "renderer/device/plan/glass_plane.hpp"

namespace scancast::gl {
namespace {

/// Of the mirror's bounds, what lies in the area; no width or height where nothing does.
ivec4 partOf(ivec4 area, const Window& bounds, int pad) {
    const int x0 = std::max(area.x, bounds.x + pad), y0 = std::max(area.y, bounds.y + pad);
    const int x1 = std::min(area.x + area.z, bounds.x + pad + bounds.width);
    const int y1 = std::min(area.y + area.w, bounds.y + pad + bounds.height);
    return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
}

}  // namespace

Expected<GpuPlanes> PlaneMemory::planes(ivec4 area, bool withNormals) {
    GpuPlanes planes;
    planes.area = area;
    planes.rgba = &rgba;
    planes.depth = &depth;
    if (withNormals) planes.normals = &normals;
    for (Buffer* const plane : {planes.rgba, planes.depth, planes.normals}) {
        if (!plane) continue;
        if (auto made = plane->reserve(planes.pixels() * 4); !made) return tl::unexpected(made.error());
    }
    return planes;
}

Expected<std::unique_ptr<MirrorLayer>> MirrorLayer::create(const LayerParts& parts, ScreenShaders& shaders,
                                                           PlaneMemory& memory, const Drawing& drawing,
                                                           const Reflection& reflection,
                                                           const Sight& picturesSight, const PassPlan& plan,
                                                           ivec4 area) {
    const ivec4 part = partOf(area, reflection.bounds, picturesSight.pad);
    if (part.z == 0 || part.w == 0) return nullptr;
    Sight sight = picturesSight;
    sight.viewpoint = &reflection.viewpoint;
    std::unique_ptr<MirrorLayer> mirror(new MirrorLayer(shaders, memory, reflection, sight, plan, part));
    auto layer = Layer::create(parts, drawing, reflection.cut, reflection.filter, mirror->sight_, plan, part);
    if (!layer) return tl::unexpected(layer.error());
    mirror->layer_ = std::move(*layer);
    return mirror;
}

Expected<void> MirrorLayer::draw(const glm::dvec2& jitter, const GpuPlanes& picture, StageTimes& times,
                                 const std::stop_token& stop) {
    const auto planes = memory_.planes(area_, plan_.resolve.normals);
    if (!planes) return tl::unexpected(planes.error());
    if (auto drawn = layer_->draw(jitter, *planes, times, stop); !drawn) return drawn;
    return lookThrough(glassNumbers(reflection_, sight_, jitter), *planes, picture, shaders_);
}

Expected<void> MirrorLayer::finish(const glm::dvec2& jitter, const GpuPlanes& picture) const {
    return tintGlass(glassNumbers(reflection_, sight_, jitter), area_, picture, shaders_);
}

}  // namespace scancast::gl
