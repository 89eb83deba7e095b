// Draws one picture's frames on the GPU: the work between a checked Drawing and its pixels on their way to
// the host. As cpu/picture.hpp: layers, mirrors, screen passes, the mean of the jittered frames. Made for one
// picture, on the device's thread, inside a Current scope. Pipeline: drawing → **picture** → read-back.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "renderer/device/gl/memory/read_back.hpp"
#include "renderer/device/gl/passes/frame_average.hpp"
#include "renderer/device/gl/passes/mirror_layer.hpp"
#include "renderer/device/gl/passes/screen_passes.hpp"
#include "renderer/device/host/drawing.hpp"

namespace scancast::gl {

/// What lives as long as the device: programs, samples, and buffers, so that pictures do not wait for fresh
/// memory.
struct DevicePool {
    /// Pictures that are read back keep the context, too (read_back.hpp).
    DevicePool(const std::shared_ptr<const Context>& context, const std::filesystem::path& programFolder,
               const Arithmetic& arithmetic, const SampleCacheOptions& cache, const SplatLimits& limits);

    const GlFunctions& gl;
    Programs programs;
    ScreenShaders shaders;
    SampleCache samples;
    Slices slices;
    SplatMemory splats;
    Pyramid pyramid;
    FrameAverage average;
    GpuTimers timers;
    StagingRing tablesRing;
    std::vector<std::unique_ptr<LayerMemory>> tables;  ///< by layer
    PlaneMemory frame;
    std::vector<std::unique_ptr<PlaneMemory>> mirrors;
    Buffer rgba, depth;  ///< of the window
    PlaneMemory sun;     ///< its map of shadows
    Buffer sunSeen;
    ReadBack readBack;
    bool exactDoubles = false;  ///< as found out when the device opens (memory/composed_runs.hpp)

    /// For a picture's layer (0), or its mirrors' and the sun's (from 1 on).
    LayerParts layerParts(std::size_t layer);
};

class Picture {
  public:
    Picture(DevicePool& pool, const Drawing& drawing, const FramePasses& passes, std::stop_token stop);
    /// Everything is asked of the GPU; its pixels arrive later. Times its stages. Errors: Cancelled,
    /// ResourceLimit, DeviceLost.
    Expected<std::unique_ptr<ReadBack::Transfer>> draw(StageTimes& times);

  private:
    Expected<void> makeLayers(StageTimes& times);
    Expected<void> drawShadowMap(StageTimes& times);
    Expected<void> drawFrame(const glm::dvec2& jitter, const GpuPlanes& planes, StageTimes& times);
    template <class Work>
    Expected<void> onMirrors(StageTimes& times, const Work& work);

    DevicePool& pool_;
    const Drawing& drawing_;
    const FramePasses& passes_;
    const std::stop_token stop_;
    const PictureArea shown_;
    const ivec4 window_, area_;
    std::unique_ptr<Layer> layer_;
    std::optional<GpuShadowMap> sun_;
    std::vector<std::unique_ptr<MirrorLayer>> mirrors_;  ///< those that lie in the area
};

}  // namespace scancast::gl
