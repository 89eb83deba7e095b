#include "renderer/device/cpu/picture.hpp"

#include <algorithm>

#include "renderer/device/cpu/grown.hpp"
#include "renderer/device/host/drawing.hpp"

namespace scancast::cpu {
namespace {

std::size_t pixelsOf(const Rect& area) {
    return static_cast<std::size_t>(area.width()) * static_cast<std::size_t>(area.height());
}

Rect rectOf(const Window& w) {
    return {w.x, w.y, w.x + w.width, w.y + w.height};
}

bool same(const Rect& a, const Rect& b) {
    return a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1;
}

}  // namespace

Picture::Picture(const Drawing& drawing, const FramePasses& passes, const Kernels& kernels, int threads,
                 tbb::task_arena& arena, Buffers& buffers, std::stop_token stop)
    : drawing_(drawing),
      passes_(passes),
      kernels_(kernels),
      workers_(arena, threads, std::move(stop), drawing.pause),
      buffers_(buffers),
      shows_(buffers.together.reduction == nullptr || buffers.together.reduction->shows()) {
    const PictureArea shown = pictureArea(drawing, passes);
    layerView_ = shown.view;
    window_ = rectOf(shown.window);
    area_ = rectOf(shown.area);
}

Planes Picture::framePlanes(std::uint32_t* out, bool first, Frame& frame) {
    Planes planes;
    planes.area = area_;
    const std::size_t pixels = pixelsOf(area_);
    if (passes_.normals()) planes.normals = grown(buffers_.frame.normals, pixels);
    if (passes_.resolve.smooth) planes.owners = &buffers_.frame.owners;
    if (same(area_, window_) && shows_) {
        planes.rgba = out;
        planes.depth = first && drawing_.depth ? frame.depth.own().data() : nullptr;
    } else {
        planes.rgba = grown(buffers_.frame.rgba, pixels);
    }
    const bool needed = !passes_.screen.empty() || !mirrors_.empty() || !same(area_, window_);
    if (planes.depth == nullptr && needed) planes.depth = grown(buffers_.frame.depth, pixels);
    return planes;
}

void Picture::crop(const Planes& planes, bool first, std::uint32_t* out, Frame& frame) {
    const int width = window_.width();
    float* const depth = first && drawing_.depth ? frame.depth.own().data() : nullptr;
    workers_.overRows(window_.height(), [&](int y0, int y1) {
        for (int y = y0; y < y1; ++y) {
            const std::ptrdiff_t from = planes.at(window_.x0, window_.y0 + y);
            const std::ptrdiff_t to = static_cast<std::ptrdiff_t>(y) * width;
            std::copy_n(planes.rgba + from, width, out + to);
            if (depth) std::copy_n(planes.depth + from, width, depth + to);
        }
    });
}

void Picture::makeMirrors() {
    for (const CutView& reflection : drawing_.reflections()) {
        const std::size_t at = mirrors_.size();
        if (buffers_.mirrors.size() <= at) buffers_.mirrors.push_back(std::make_unique<LayerMemory>());
        auto layer =
            std::make_unique<MirrorLayer>(drawing_, reflection, layerView_, passes_, kernels_, workers_,
                                          buffers_.tiles, *buffers_.mirrors[at], area_, together());
        if (!layer->empty()) mirrors_.push_back(std::move(layer));
    }
}

/// Once for all frames: the sun does not move by a part of a pixel.
void Picture::drawShadowMap(FrameStats& stats) {
    const auto start = workers_.now();
    const CutView& sun = *drawing_.sun;
    const FramePasses passes = shadowMapPasses(drawing_.surfels);
    Drawing drawing = drawing_;
    drawing.color = ColorRule{.source = ColorSource::Flat};
    const LayerView layerView{&sun.viewpoint, 0, drawing_.surfels, drawing_.oriented};
    Planes planes;
    planes.area = {0, 0, sun.viewpoint.width, sun.viewpoint.height};
    planes.rgba = grown(buffers_.sun.rgba, pixelsOf(planes.area));
    planes.depth = grown(buffers_.sun.depth, pixelsOf(planes.area));
    FrameStats own;  // one stage of the picture's
    Layer(drawing, sun, layerView, passes, kernels_, workers_, buffers_.tiles, planes.area, together())
        .draw({0, 0}, planes, own);
    sun_ = ShadowMap{&sun.viewpoint, planes.depth};
    stats.add("shadow map", workers_.millisecondsSince(start));
}

template <class Work>
void Picture::onMirrors(FrameStats& stats, const Work& work) {
    if (mirrors_.empty()) return;
    const auto start = workers_.now();
    for (const auto& mirror : mirrors_) {
        if (!workers_.stopped()) work(*mirror);
    }
    stats.add("mirrors", workers_.millisecondsSince(start));
}

void Picture::drawFrame(Layer& layer, const glm::dvec2& jitter, bool first, std::uint32_t* out,
                        Frame& frame) {
    const Planes planes = framePlanes(out, first, frame);
    layer.draw(jitter, planes, frame.stats);
    onMirrors(frame.stats, [&](MirrorLayer& mirror) { mirror.draw(jitter, planes); });
    if (!shows_) return;
    runScreenPasses(passes_.screen, layerView_, jitter, planes, kernels_, workers_, buffers_.screen,
                    frame.stats, sun_ ? &*sun_ : nullptr);
    onMirrors(frame.stats, [&](const MirrorLayer& mirror) { mirror.finish(jitter, planes); });
    if (planes.rgba != out && !workers_.stopped()) crop(planes, first, out, frame);
}

void Picture::accumulate(const std::uint32_t* rgba) {
    workers_.overRows(window_.height(), [&](int y0, int y1) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y0) * window_.width();
        kernels_.accumulate(reinterpret_cast<const std::uint8_t*>(rgba + first),
                            buffers_.sums.data() + 4 * first, 4 * (y1 - y0) * window_.width());
    });
}

void Picture::drawAveraged(Layer& layer, Frame& frame) {
    const std::size_t pixels = pixelsOf(window_);
    std::uint32_t* const one = grown(buffers_.one, pixels);
    buffers_.sums.assign(pixels * 4, 0);
    for (std::size_t i = 0; i < drawing_.jitter.size() && !workers_.stopped(); ++i) {
        drawFrame(layer, drawing_.jitter[i], i == 0, one, frame);
        if (!shows_) continue;
        const auto start = workers_.now();
        accumulate(one);
        frame.stats.add("average", workers_.millisecondsSince(start));
    }
    if (!shows_) return;
    const auto start = workers_.now();
    std::uint8_t* const mean = frame.rgba.own().data();
    workers_.overRows(window_.height(), [&](int y0, int y1) {
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y0) * window_.width();
        kernels_.average(buffers_.sums.data() + 4 * first, mean + 4 * first, (y1 - y0) * window_.width(),
                         static_cast<int>(drawing_.jitter.size()));
    });
    frame.stats.add("average", workers_.millisecondsSince(start));
}

Expected<Frame> Picture::draw() {
    const auto start = workers_.now();
    Frame frame;
    frame.width = window_.width();
    frame.height = window_.height();
    if (shows_) frame.rgba.own().resize(pixelsOf(window_) * 4);
    if (shows_ && drawing_.depth) frame.depth.own().resize(pixelsOf(window_));
    Layer layer(drawing_, drawing_.mainView(), layerView_, passes_, kernels_, workers_, buffers_.tiles, area_,
                together());
    frame.stats.add("nearest", workers_.millisecondsSince(start));
    if (!drawing_.reflections().empty()) {
        const auto mirrorsStart = workers_.now();
        makeMirrors();
        if (!mirrors_.empty()) frame.stats.add("mirrors", workers_.millisecondsSince(mirrorsStart));
    }
    if (drawing_.sun != nullptr && passes_.castsShadows() && !workers_.stopped()) drawShadowMap(frame.stats);
    if (drawing_.jitter.size() == 1) {
        drawFrame(layer, drawing_.jitter[0], true, reinterpret_cast<std::uint32_t*>(frame.rgba.own().data()),
                  frame);
    } else {
        drawAveraged(layer, frame);
    }
    if (workers_.stopped())
        return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
    tellCuts(drawing_.cuts, frame.stats);
    frame.stats.device = "cpu";
    return frame;
}

}  // namespace scancast::cpu
