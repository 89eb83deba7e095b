#include "renderer/device/gl/passes/picture.hpp"

#include <utility>

namespace scancast::gl {
namespace {

/// Of a picture of a hundred million points, all its tables.
constexpr std::size_t tablesRingBytes = std::size_t{16} << 20;

ivec4 vectorOf(const Window& w) {
    return {w.x, w.y, w.width, w.height};
}

}  // namespace

DevicePool::DevicePool(const std::shared_ptr<const Context>& context,
                       const std::filesystem::path& programFolder, const Arithmetic& arithmetic,
                       const SampleCacheOptions& cache, const SplatLimits& limits)
    : gl(context->functions()),
      programs(gl, programFolder, arithmetic),
      shaders(gl, programs),
      samples(gl, cache),
      slices(gl),
      splats(gl, limits),
      pyramid(shaders),
      average(shaders),
      timers(gl),
      tablesRing(gl, tablesRingBytes),
      frame(gl),
      rgba(gl, "picture's colours"),
      depth(gl, "picture's depths"),
      sun(gl),
      sunSeen(gl, "sunlight"),
      readBack(gl, context) {}

LayerParts DevicePool::layerParts(std::size_t layer) {
    while (tables.size() <= layer) tables.push_back(std::make_unique<LayerMemory>(gl, tablesRing));
    return {gl, programs, shaders, samples, slices, splats, *tables[layer], exactDoubles};
}

Picture::Picture(DevicePool& pool, const Drawing& drawing, const FramePasses& passes, std::stop_token stop)
    : pool_(pool),
      drawing_(drawing),
      passes_(passes),
      stop_(std::move(stop)),
      shown_(pictureArea(drawing, passes)),
      window_(vectorOf(shown_.window)),
      area_(vectorOf(shown_.area)) {}

Expected<void> Picture::makeLayers(StageTimes& times) {
    const StageTimes::HostScope timed(times, "prepare");
    auto layer =
        Layer::create(pool_.layerParts(0), drawing_, drawing_.mainView(), shown_.view, passes_, area_);
    if (!layer) return passOn(layer);
    layer_ = std::move(*layer);
    for (const CutView& reflection : drawing_.reflections()) {
        const std::size_t at = mirrors_.size();
        if (pool_.mirrors.size() <= at) pool_.mirrors.push_back(std::make_unique<PlaneMemory>(pool_.gl));
        auto mirror = MirrorLayer::create(pool_.layerParts(at + 1), pool_.shaders, *pool_.mirrors[at],
                                          drawing_, reflection, shown_.view, passes_, area_);
        if (!mirror) return passOn(mirror);
        if (*mirror) mirrors_.push_back(std::move(*mirror));
    }
    return {};
}

/// Once for all frames: the sun does not move by a part of a pixel.
Expected<void> Picture::drawShadowMap(StageTimes& times) {
    const CutView& sun = *drawing_.sun;
    const FramePasses passes = shadowMapPasses(drawing_.surfels);
    Drawing drawing = drawing_;
    drawing.color = ColorRule{.source = ColorSource::Flat};
    const ivec4 area(0, 0, sun.viewpoint.width, sun.viewpoint.height);
    const LayerView layerView{&sun.viewpoint, 0, drawing_.surfels, drawing_.oriented};
    const auto planes = pool_.sun.planes(area, false);
    if (!planes) return passOn(planes);
    const StageTimes::Scope timed(times, "shadow map");
    const auto layer =
        Layer::create(pool_.layerParts(drawing_.cuts.size()), drawing, sun, layerView, passes, area);
    if (!layer) return passOn(layer);
    if (auto ok = (*layer)->draw({0, 0}, *planes, times, stop_); !ok) return ok;
    sun_ = GpuShadowMap{&sun.viewpoint, planes->depth, &pool_.sunSeen};
    return {};
}

template <class Work>
Expected<void> Picture::onMirrors(StageTimes& times, const Work& work) {
    if (mirrors_.empty()) return {};
    const StageTimes::Scope timed(times, "mirrors");
    for (const auto& mirror : mirrors_) {
        if (auto ok = work(*mirror); !ok) return ok;
    }
    return {};
}

Expected<void> Picture::drawFrame(const glm::dvec2& jitter, const GpuPlanes& planes, StageTimes& times) {
    if (auto ok = layer_->draw(jitter, planes, times, stop_); !ok) return ok;
    auto reflected =
        onMirrors(times, [&](MirrorLayer& mirror) { return mirror.draw(jitter, planes, times, stop_); });
    if (!reflected) return reflected;
    auto screened = runScreenPasses(passes_.screen, shown_.view, jitter, planes, pool_.shaders, pool_.pyramid,
                                    times, stop_, sun_ ? &*sun_ : nullptr);
    if (!screened) return screened;
    return onMirrors(times, [&](const MirrorLayer& mirror) { return mirror.finish(jitter, planes); });
}

Expected<std::unique_ptr<ReadBack::Transfer>> Picture::draw(StageTimes& times) {
    if (drawing_.sun != nullptr && passes_.castsShadows()) {
        if (auto ok = drawShadowMap(times); !ok) return passOn(ok);
    }
    if (auto ok = makeLayers(times); !ok) return passOn(ok);
    const auto planes = pool_.frame.planes(area_, passes_.normals());
    if (!planes) return passOn(planes);
    const std::size_t pixels = static_cast<std::size_t>(window_.z) * static_cast<std::size_t>(window_.w);
    const bool averaged = drawing_.jitter.size() > 1;
    // One frame with nothing around it is read from where it was drawn.
    const bool asDrawn = !averaged && area_ == window_;
    Expected<void> done;
    if (!asDrawn) done = pool_.rgba.reserve(pixels * 4);
    if (done && !asDrawn && drawing_.depth) done = pool_.depth.reserve(pixels * 4);
    if (done && averaged) done = pool_.average.begin(window_.z, window_.w);
    for (std::size_t i = 0; done && i < drawing_.jitter.size(); ++i) {
        done = drawFrame(drawing_.jitter[i], *planes, times);
        if (done && i == 0 && !asDrawn && drawing_.depth)
            done = crop(*planes->depth, area_, window_, pool_.depth, pool_.shaders);
        if (done && averaged) {
            const StageTimes::Scope timed(times, "average");
            done = pool_.average.add(*planes, window_);
        }
    }
    if (done && !asDrawn) {
        const StageTimes::Scope timed(times, averaged ? "average" : "read-back");
        done = averaged ? pool_.average.write(pool_.rgba)
                        : crop(*planes->rgba, area_, window_, pool_.rgba, pool_.shaders);
    }
    if (!done) return passOn(done);
    const StageTimes::Scope timed(times, "read-back");
    const Buffer* const depth = !drawing_.depth ? nullptr : asDrawn ? planes->depth : &pool_.depth;
    return pool_.readBack.start(asDrawn ? *planes->rgba : pool_.rgba, depth, pixels);
}

}  // namespace scancast::gl
