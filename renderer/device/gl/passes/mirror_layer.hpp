// A mirror of a picture on the GPU: the layer that its reflected eye sees, only as large as the mirror
// appears, and its glass (docs/spec/mirrors.md §3). As cpu/mirror_layer.hpp: both are layers of splats,
// screen passes run once over the picture with the reflections in it, and only in the end it becomes glass.
// Made for one picture, on the device's thread; everything, destruction included, inside a Current scope.
#pragma once

#include <memory>

#include "renderer/device/gl/passes/glass.hpp"
#include "renderer/device/gl/passes/layer.hpp"

namespace scancast::gl {

/// The planes of one layer; live as long as the device, so that pictures do not wait for fresh memory.
struct PlaneMemory {
    explicit PlaneMemory(const GlFunctions& gl)
        : rgba(gl, "colours"), depth(gl, "depths"), normals(gl, "normals") {}
    /// Room for the planes of an area.
    Expected<GpuPlanes> planes(ivec4 area, bool withNormals);

    Buffer rgba, depth, normals;
};

class MirrorLayer {
  public:
    /// `area` is what is drawn of the picture; null where nothing of the mirror lies in it. Everything given
    /// outlives the layer. Errors: the layer's.
    static Expected<std::unique_ptr<MirrorLayer>> create(const LayerParts& parts, ScreenShaders& shaders,
                                                         PlaneMemory& memory, const Drawing& drawing,
                                                         const CutView& reflection, const LayerView& mainView,
                                                         const FramePasses& passes, ivec4 area);

    /// Draws one frame of the reflection into the same frame of the picture. Before its screen passes.
    Expected<void> draw(const glm::dvec2& jitter, const GpuPlanes& picture, StageTimes& times,
                        const std::stop_token& stop);
    /// Tint, and the mirror's depth. After the screen passes.
    Expected<void> finish(const glm::dvec2& jitter, const GpuPlanes& picture) const;

  private:
    MirrorLayer(ScreenShaders& shaders, PlaneMemory& memory, const MirrorGlass& glass,
                const LayerView& layerView, const FramePasses& passes, ivec4 area)
        : shaders_(shaders),
          memory_(memory),
          glass_(glass),
          layerView_(layerView),
          passes_(passes),
          area_(area) {}

    ScreenShaders& shaders_;
    PlaneMemory& memory_;
    const MirrorGlass& glass_;
    const LayerView layerView_;  ///< of the reflected eye
    const FramePasses& passes_;
    const ivec4 area_;  ///< pixels that may change
    std::unique_ptr<Layer> layer_;
};

}  // namespace scancast::gl
