// One cut seen from one viewpoint: its runs made ready once, then drawn once per jittered frame through all
// splat passes and resolved into planes of pixels. A picture is a layer; every mirror that it shows is
// another. The GPU's counterpart of cpu/layer.hpp. Place: cut → **layer** → screen passes.
//
// Made for one draw() of the device, on its thread; everything, destruction included, inside a Current scope.
#pragma once

#include <memory>
#include <stop_token>
#include <vector>

#include "renderer/device/gl/memory/layer_memory.hpp"
#include "renderer/device/gl/memory/sample_cache.hpp"
#include "renderer/device/gl/memory/splat_memory.hpp"
#include "renderer/device/gl/memory/splat_params.hpp"
#include "renderer/device/gl/passes/gpu_timers.hpp"
#include "renderer/device/gl/passes/planes.hpp"
#include "renderer/device/gl/passes/slices.hpp"
#include "renderer/device/gl/programs/programs.hpp"
#include "renderer/device/gl/programs/screen_shaders.hpp"
#include "renderer/device/gl/programs/splat_variants.hpp"

namespace scancast::gl {

/// What the device lends to a layer.
struct LayerParts {
    const GlFunctions& gl;
    Programs& programs;
    ScreenShaders& screen;
    SampleCache& samples;
    Slices& slices;
    SplatMemory& memory;  ///< of the layer being drawn: all layers of a device may share one
    LayerMemory& tables;  ///< this layer's alone
    /// The GPU's doubles round as the processor's (memory/composed_runs.hpp).
    bool exactDoubles = false;
};

class Layer {
  public:
    ~Layer();
    Layer(const Layer&) = delete;

    /// `area` (x, y, width, height) of the whole picture, shifted by layerView.pad as planes are. Everything
    /// given outlives the layer. ResourceLimit: too many runs for a storage block, or no memory.
    static Expected<std::unique_ptr<Layer>> create(const LayerParts& parts, const Drawing& drawing,
                                                   const CutView& view, const LayerView& layerView,
                                                   const FramePasses& passes, ivec4 area);

    /// Splats and resolves one frame; `planes` cover the layer's area, and nothing outside it is touched.
    /// Normals are written where there is a plane of them and the frame resolves them. Adds to the stages
    /// "prepare" (the host finds or uploads samples, and tells where they are), "silhouette", "nearest",
    /// "sum", "cell", "resolve" and "smooth". Errors: Cancelled, ResourceLimit, DeviceLost.
    Expected<void> draw(const glm::dvec2& jitter, const GpuPlanes& planes, StageTimes& times,
                        const std::stop_token& stop);

  private:
    Layer(const LayerParts& parts, const Drawing& drawing, const CutView& view, const LayerView& layerView,
          const FramePasses& passes, ivec4 area);
    std::vector<DrawnRun> addRuns(const Drawing& drawing, const CutView& view);
    void findSamples(const Cut& cut, std::vector<DrawnRun> drawn);
    Expected<void> upload();
    Expected<void> compose();
    Expected<void> gather(StageTimes& times, const std::stop_token& stop);
    Expected<void> begin(const SampleBatch& batch);
    Expected<void> drawBand(ivec4 band, std::span<const SplatPass> splats, const GpuPlanes& planes,
                            StageTimes& times, const std::stop_token& stop);
    Expected<void> splat(std::size_t index, const SplatPass& pass, ivec4 band, const std::stop_token& stop);
    Expected<void> splatKeys(const SplatPass& pass, KeyPlane& into, std::size_t pixels,
                             const std::stop_token& stop);
    Expected<void> splatOnce(const SplatPass& pass, Keep keep, const std::stop_token& stop);
    /// `pass`: a splat pass, of which all know the frame's view.
    Expected<void> resolve(const SplatPass& pass, ivec4 band, const GpuPlanes& planes,
                           const std::stop_token& stop);
    Expected<void> resolveKeys(const ResolveParams& params, const GpuPlanes& planes, bool normals);
    Expected<void> resolveSamples(ResolveParams params, const GpuPlanes& planes, bool normals,
                                  const std::stop_token& stop);
    Expected<void> resolveSums(const ResolveParams& params, const GpuPlanes& planes, bool normals);
    Expected<void> smooth(const SplatPass& pass, const GpuPlanes& planes);
    Expected<void> overPixels(ivec4 area, const ShaderVariant& variant);
    /// The keys that colours come from.
    const KeyPlane& colors() const;
    void bindColors() const;
    void bindSurfaces(const KeyPlane& plane) const;

    const LayerParts parts_;
    const LayerView layerView_;
    const FramePasses& passes_;
    const ivec4 area_;
    std::vector<SplatPass> splats_;
    LayerTraits traits_;
    std::uint32_t chunkSamples_ = 0;         ///< of a chunk at most
    std::vector<std::uint32_t> background_;  ///< rows of area_
    const bool byClass_;
    std::vector<std::uint32_t> runOfCut_;  ///< from the cut's runs to the tables'
    KeptSamples samples_;                  ///< of the layer before, where that drew the same
    bool composed_ = false;                ///< the GPU has its runs as they are seen from here
};

}  // namespace scancast::gl
