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

/// Whether all devices do the screen passes, each of its own rows: where these need little of others'.
void Picture::divideScreen() {
    if (together() == nullptr) return;
    const auto looksFar = [](const Pass& pass) {
        return !(std::holds_alternative<PhongPass>(pass) || std::holds_alternative<ShadowPass>(pass) ||
                 std::holds_alternative<EyeDomePass>(pass) || std::holds_alternative<OcclusionPass>(pass));
    };
    const int rowsOfEach = area_.height() / static_cast<int>(together()->reduction->devices());
    divided_ = drawing_.reflections().empty() && std::ranges::none_of(passes_.screen, looksFar) &&
               2 * passes_.reach() <= rowsOfEach;
    together()->reach = divided_ ? passes_.reach() : passes_.resolve.smooth ? 1 : 0;
}

/// `out`: of the window; without depth where none is wanted of this frame.
Planes Picture::framePlanes(const Planes& out, LayerMemory& memory) {
    Planes planes;
    planes.area = area_;
    const std::size_t pixels = pixelsOf(area_);
    if (passes_.normals()) planes.normals = grown(memory.normals, pixels);
    if (passes_.resolve.smooth) planes.owners = &memory.owners;
    if (same(area_, window_)) {
        planes.rgba = out.rgba;
        planes.depth = out.depth;
    } else {
        planes.rgba = grown(memory.rgba, pixels);
    }
    const bool needed = !passes_.screen.empty() || !mirrors_.empty() || !same(area_, window_);
    if (planes.depth == nullptr && needed) planes.depth = grown(memory.depth, pixels);
    return planes;
}

/// Of the window, those that this device finishes.
Rows Picture::finishedRows(const Layer& layer) const {
    const Rows whole{0, window_.height()};
    if (!divided_) return shows_ ? whole : Rows{};
    const Rows own = layer.ownRows();
    const int above = window_.y0 - area_.y0;
    return Rows{own.y0 - above, own.y1 - above}.intersect(whole);
}

/// work(first pixel, pixels): in some rows of them at a time.
template <class Work>
void Picture::overFinished(const Layer& layer, const Work& work) const {
    const Rows rows = finishedRows(layer);
    workers_.overRows(rows.count(), [&](int y0, int y1) {
        work(std::ptrdiff_t{rows.y0 + y0} * window_.width(), (y1 - y0) * window_.width());
    });
}

void Picture::crop(const Layer& layer, const Planes& planes, const Planes& out) {
    const int width = window_.width();
    overFinished(layer, [&](std::ptrdiff_t first, int count) {
        for (std::ptrdiff_t to = first; to < first + count; to += width) {
            const std::ptrdiff_t from = planes.at(window_.x0, window_.y0 + static_cast<int>(to / width));
            std::copy_n(planes.rgba + from, width, out.rgba + to);
            if (out.depth != nullptr) std::copy_n(planes.depth + from, width, out.depth + to);
        }
    });
}

void Picture::collect(Layer& layer, const Planes& planes, FrameStats& stats, Receivers to) {
    const auto start = workers_.now();
    layer.collect(planes, to);
    stats.add("collect", workers_.millisecondsSince(start));
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
    Layer layer(drawing, sun, layerView, passes, kernels_, workers_, buffers_.tiles, planes.area, together());
    layer.draw({0, 0}, planes, own);
    if (together() != nullptr) layer.collect(planes, divided_ ? Receivers::Everybody : Receivers::WhoShows);
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

void Picture::drawFrame(Layer& layer, const glm::dvec2& jitter, const Planes& out, FrameStats& stats) {
    const Planes planes = framePlanes(out, buffers_.frames.front());
    layer.draw(jitter, planes, stats);
    finishFrame(layer, jitter, planes, out, stats);
}

/// Once its layer has been drawn into `planes`.
void Picture::finishFrame(Layer& layer, const glm::dvec2& jitter, const Planes& planes, const Planes& out,
                          FrameStats& stats) {
    if (together() != nullptr && !divided_) {
        Planes resolved = planes;
        if (!passes_.resolve.normals) resolved.normals = nullptr;
        collect(layer, resolved, stats);
    }
    onMirrors(stats, [&](MirrorLayer& mirror) { mirror.draw(jitter, planes); });
    if ((!shows_ && !divided_) || workers_.stopped()) return;
    runScreenPasses(passes_.screen, layerView_, jitter, divided_ ? layer.own(planes) : planes, kernels_,
                    workers_, buffers_.screen, stats, sun_ ? &*sun_ : nullptr);
    onMirrors(stats, [&](const MirrorLayer& mirror) { mirror.finish(jitter, planes); });
    if (planes.rgba != out.rgba && !workers_.stopped()) crop(layer, planes, out);
}

void Picture::accumulate(const Layer& layer, const std::uint32_t* rgba) {
    overFinished(layer, [&](std::ptrdiff_t first, int count) {
        kernels_.accumulate(reinterpret_cast<const std::uint8_t*>(rgba + first),
                            buffers_.sums.data() + 4 * first, 4 * count);
    });
}

void Picture::drawAveraged(Layer& layer, const Planes& out, FrameStats& stats) {
    const std::size_t pixels = pixelsOf(window_);
    buffers_.sums.assign(pixels * 4, 0);
    const auto atOnce =
        static_cast<std::size_t>(layer.framesAtOnce(std::int64_t{area_.width()} * area_.height()));
    std::array<Planes, mostFrames> outs, planes;
    for (std::size_t first = 0; first < drawing_.jitter.size(); first += atOnce) {
        const auto jitters = drawing_.jitter.subspan(first, std::min(atOnce, drawing_.jitter.size() - first));
        for (std::size_t f = 0; f < jitters.size(); ++f) {
            outs[f] = out;
            if (first + f > 0) outs[f].depth = nullptr;  // the first frame's
            outs[f].rgba = grown(buffers_.averaged[f], pixels);
            planes[f] = framePlanes(outs[f], buffers_.frames[f]);
        }
        layer.draw(jitters, {planes.data(), jitters.size()}, stats);
        for (std::size_t f = 0; f < jitters.size(); ++f) {
            if (!workers_.stopped()) finishFrame(layer, jitters[f], planes[f], outs[f], stats);
            if (workers_.stopped()) return;
            const auto start = workers_.now();
            accumulate(layer, outs[f].rgba);
            stats.add("average", workers_.millisecondsSince(start));
        }
    }
    const auto start = workers_.now();
    std::uint8_t* const mean = reinterpret_cast<std::uint8_t*>(out.rgba);
    overFinished(layer, [&](std::ptrdiff_t first, int count) {
        kernels_.average(buffers_.sums.data() + 4 * first, mean + 4 * first, count,
                         static_cast<int>(drawing_.jitter.size()));
    });
    stats.add("average", workers_.millisecondsSince(start));
}

/// Of the window; where others show it, the device's own.
Planes Picture::windowPlanes(Frame& frame) {
    const std::size_t pixels = pixelsOf(window_);
    Planes out;
    out.area = window_;
    if (shows_) {
        frame.rgba.own().resize(pixels * 4);
        if (drawing_.depth) frame.depth.own().resize(pixels);
        out.rgba = reinterpret_cast<std::uint32_t*>(frame.rgba.own().data());
        out.depth = drawing_.depth ? frame.depth.own().data() : nullptr;
    } else {
        out.rgba = grown(buffers_.rgba, pixels);
        out.depth = drawing_.depth ? grown(buffers_.depth, pixels) : nullptr;
    }
    return out;
}

Expected<Frame> Picture::draw() {
    const auto start = workers_.now();
    Frame frame;
    frame.width = window_.width();
    frame.height = window_.height();
    const Planes out = windowPlanes(frame);
    divideScreen();
    Layer layer(drawing_, drawing_.mainView(), layerView_, passes_, kernels_, workers_, buffers_.tiles, area_,
                together());
    frame.stats.add("nearest", workers_.millisecondsSince(start));
    if (!drawing_.reflections().empty()) {
        const auto mirrorsStart = workers_.now();
        makeMirrors();
        if (!mirrors_.empty()) frame.stats.add("mirrors", workers_.millisecondsSince(mirrorsStart));
    }
    if (drawing_.sun != nullptr && passes_.castsShadows() && !workers_.stopped()) drawShadowMap(frame.stats);
    if (drawing_.jitter.size() == 1)
        drawFrame(layer, drawing_.jitter[0], out, frame.stats);
    else
        drawAveraged(layer, out, frame.stats);
    if (divided_) collect(layer, out, frame.stats);
    if (workers_.stopped())
        return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
    tellCuts(drawing_.cuts, frame.stats);
    frame.stats.device = "cpu";
    return frame;
}

}  // namespace scancast::cpu
