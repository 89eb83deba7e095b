#include "renderer/device/gl/passes/mirror_layer.hpp"

#include <algorithm>

#include "renderer/device/host/screens.hpp"

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
        if (auto ok = plane->reserve(planes.pixels() * 4); !ok) return passOn(ok);
    }
    return planes;
}

Expected<std::unique_ptr<MirrorLayer>> MirrorLayer::create(const LayerParts& parts, ScreenShaders& shaders,
                                                           PlaneMemory& memory, const Drawing& drawing,
                                                           const CutView& reflection,
                                                           const LayerView& mainView,
                                                           const FramePasses& passes, ivec4 area) {
    const ivec4 part = partOf(area, reflection.glass->bounds, mainView.pad);
    if (part.z == 0 || part.w == 0) return nullptr;
    LayerView layerView = mainView;
    layerView.viewpoint = &reflection.viewpoint;
    std::unique_ptr<MirrorLayer> mirror(
        new MirrorLayer(shaders, memory, *reflection.glass, layerView, passes, part));
    auto layer = Layer::create(parts, drawing, reflection, mirror->layerView_, passes, part);
    if (!layer) return passOn(layer);
    mirror->layer_ = std::move(*layer);
    return mirror;
}

Expected<void> MirrorLayer::draw(const glm::dvec2& jitter, const GpuPlanes& picture, StageTimes& times,
                                 const std::stop_token& stop) {
    const auto planes = memory_.planes(area_, passes_.resolve.normals);
    if (!planes) return passOn(planes);
    if (auto ok = layer_->draw(jitter, *planes, times, stop); !ok) return ok;
    return lookThrough(glassNumbers(glass_, layerView_, jitter), *planes, picture, shaders_);
}

Expected<void> MirrorLayer::finish(const glm::dvec2& jitter, const GpuPlanes& picture) const {
    return tintGlass(glassNumbers(glass_, layerView_, jitter), area_, picture, shaders_);
}

}  // namespace scancast::gl
