// Draws one picture's frames on the CPU: the work between a checked Drawing and its Frame. Made for one
// draw() and thrown away with it, on the render thread; the tasks that it starts run in the device's arena.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/device/cpu/layer.hpp"
#include "renderer/device/cpu/mirror_layer.hpp"
#include "renderer/device/cpu/screen_passes.hpp"

namespace scancast::cpu {

/// Buffers that live as long as the device, so that pictures do not wait for fresh memory.
struct Buffers {
    TileMemories tiles;
    std::array<LayerMemory, mostFrames> frames;  ///< with their margins
    std::vector<std::unique_ptr<LayerMemory>> mirrors;
    ScreenMemory screen;
    LayerMemory sun;  ///< its map of shadows
    Together together;
    std::array<std::vector<std::uint32_t>, mostFrames> averaged;  ///< frames that are to be
    std::vector<std::uint16_t> sums;
    std::vector<std::uint32_t> rgba;  ///< of the window, where others show it
    std::vector<float> depth;
};

class Picture {
  public:
    Picture(const Drawing& drawing, const FramePasses& passes, const Kernels& kernels, int threads,
            tbb::task_arena& arena, Buffers& buffers, std::stop_token stop);
    /// Without pixels where others show them (pass_reduction.hpp).
    Expected<Frame> draw();

  private:
    Together* together() { return buffers_.together.reduction != nullptr ? &buffers_.together : nullptr; }
    Planes windowPlanes(Frame& frame);
    Planes framePlanes(const Planes& out, LayerMemory& memory);
    template <class Work>
    void onMirrors(FrameStats& stats, const Work& work);
    void drawFrame(Layer& layer, const glm::dvec2& jitter, const Planes& out, FrameStats& stats);
    void finishFrame(Layer& layer, const glm::dvec2& jitter, const Planes& planes, const Planes& out,
                     FrameStats& stats);
    void makeMirrors();
    void divideScreen();
    void collect(Layer& layer, const Planes& planes, FrameStats& stats, Receivers to = Receivers::WhoShows);
    Rows finishedRows(const Layer& layer) const;
    template <class Work>
    void overFinished(const Layer& layer, const Work& work) const;
    void drawShadowMap(FrameStats& stats);
    void crop(const Layer& layer, const Planes& planes, const Planes& out);
    void drawAveraged(Layer& layer, const Planes& out, FrameStats& stats);
    void accumulate(const Layer& layer, const std::uint32_t* rgba);

    const Drawing& drawing_;
    const FramePasses& passes_;
    const Kernels& kernels_;
    const Workers workers_;
    Buffers& buffers_;
    const bool shows_;
    bool divided_ = false;  ///< all devices finish rows of their own, and who shows gets pixels
    LayerView layerView_;
    Rect window_;
    Rect area_;  ///< the window, and what screen passes look at beyond it
    std::optional<ShadowMap> sun_;
    std::vector<std::unique_ptr<MirrorLayer>> mirrors_;  ///< those that lie in the area
};

}  // namespace scancast::cpu
