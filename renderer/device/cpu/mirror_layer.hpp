// A mirror of a picture: the layer that its reflected eye sees, only as large as the mirror appears, and its
// glass (docs/spec/mirrors.md §3). Both are layers of splats; screen passes run once, over the picture with
// the reflections in it, just as if the mirror were an opening and its image stood behind it: that is how
// depths around an edge of the glass must be compared. Only in the end it becomes glass, with a tint and a
// depth of its own. Once per jittered frame, before frames are averaged. Made for one draw(), on the render
// thread.
#pragma once

#include <optional>

#include "renderer/device/cpu/layer.hpp"

namespace scancast::cpu {

/// The planes of one layer; live as long as the device, so that pictures do not wait for fresh memory.
struct LayerMemory {
    std::vector<std::uint32_t> rgba, normals;
    std::vector<float> depth;
    OwnerMemory owners;
};

class MirrorLayer {
  public:
    /// `picture`: the area that is drawn of it. Everything outlives the layer.
    MirrorLayer(const Drawing& drawing, const CutView& reflection, const LayerView& mainView,
                const FramePasses& passes, const Kernels& kernels, const Workers& workers,
                TileMemories& tiles, LayerMemory& memory, const Rect& picture, Together* together = nullptr);

    /// Nothing of it lies in the picture.
    bool empty() const { return area_.empty(); }
    /// Draws one frame of the reflection into the same frame of the picture, whose planes have depth. Before
    /// its screen passes. Expects !empty(). Together with others, in the end only who shows has them.
    void draw(const glm::dvec2& jitter, const Planes& picture);
    /// Tint, and the mirror's depth. After the screen passes.
    void finish(const glm::dvec2& jitter, const Planes& picture) const;

  private:
    using Lay = void (*)(const Glass&);
    void layOver(const glm::dvec2& jitter, const Planes& reflected, const Planes& picture, Lay lay) const;

    const MirrorGlass& glass_;
    const LayerView layerView_;  ///< of the reflected eye
    const FramePasses& passes_;
    const Kernels& kernels_;
    const Workers& workers_;
    LayerMemory& memory_;
    Together* const together_;    ///< null: it is drawn alone
    Rect area_;                   ///< pixels that may change
    std::optional<Layer> layer_;  ///< unless empty
};

}  // namespace scancast::cpu
