#include "renderer/device/cpu/mirror_layer.hpp"

#include "renderer/device/cpu/grown.hpp"
#include "renderer/device/host/screens.hpp"

namespace scancast::cpu {
namespace {

Rect areaOf(const MirrorGlass& glass, int pad, const Rect& picture) {
    const Window& b = glass.bounds;
    return Rect{b.x + pad, b.y + pad, b.x + b.width + pad, b.y + b.height + pad}.intersect(picture);
}

}  // namespace

MirrorLayer::MirrorLayer(const Drawing& drawing, const CutView& reflection, const LayerView& mainView,
                         const FramePasses& passes, const Kernels& kernels, const Workers& workers,
                         TileMemories& tiles, LayerMemory& memory, const Rect& picture, Together* together)
    : glass_(*reflection.glass),
      layerView_{&reflection.viewpoint, mainView.pad,           mainView.surfels,
                 mainView.oriented,     mainView.orientedNodes, mainView.curvatures},
      passes_(passes),
      kernels_(kernels),
      workers_(workers),
      memory_(memory),
      together_(together),
      area_(areaOf(*reflection.glass, mainView.pad, picture)) {
    if (!empty())
        layer_.emplace(drawing, reflection, layerView_, passes, kernels, workers, tiles, area_, together);
}

void MirrorLayer::draw(const glm::dvec2& jitter, const Planes& picture) {
    const std::size_t pixels =
        static_cast<std::size_t>(area_.width()) * static_cast<std::size_t>(area_.height());
    Planes planes;
    planes.area = area_;
    planes.rgba = grown(memory_.rgba, pixels);
    planes.depth = grown(memory_.depth, pixels);
    if (passes_.resolve.normals) planes.normals = grown(memory_.normals, pixels);
    if (passes_.resolve.smooth) planes.owners = &memory_.owners;
    FrameStats own;  // its stages are the picture's one stage "mirrors"
    layer_->draw(jitter, planes, own);
    if (together_ != nullptr) layer_->collect(planes, Receivers::WhoShows);
    if (together_ == nullptr || together_->reduction->shows())
        layOver(jitter, planes, picture, kernels_.lookThrough);
}

void MirrorLayer::finish(const glm::dvec2& jitter, const Planes& picture) const {
    layOver(jitter, {}, picture, kernels_.tintGlass);
}

void MirrorLayer::layOver(const glm::dvec2& jitter, const Planes& reflected, const Planes& picture,
                          Lay lay) const {
    Glass whole;
    static_cast<GlassNumbers&>(whole) = glassNumbers(glass_, layerView_, jitter);
    whole.stride = picture.area.width();
    whole.reflectedStride = area_.width();
    whole.x = area_.x0;
    whole.width = area_.width();
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
