#include "renderer/draw.hpp"

#include <algorithm>
#include <vector>

#include "renderer/device/host/drawing.hpp"
#include "renderer/image/clock.hpp"
#include "renderer/jitter.hpp"
#include "renderer/residency/on_device.hpp"
#include "renderer/tiled_picture.hpp"

namespace scancast {
namespace {

/// Blocks that some cut of a picture lacks because they cannot be read. A node that several want is one.
std::uint32_t countDamaged(std::span<const CutView> cuts, const std::optional<CutView>& sun) {
    std::vector<std::uint32_t> all;
    const auto add = [&](const CutView& view) {
        all.insert(all.end(), view.cut.damaged.begin(), view.cut.damaged.end());
    };
    for (const CutView& view : cuts) add(view);
    if (sun) add(*sun);
    std::ranges::sort(all);
    return static_cast<std::uint32_t>(std::ranges::unique(all).begin() - all.begin());
}

/// All that a frame's statistics say but the device's stages.
FrameStats statsOf(const PreparedView& prepared, double provideMs, std::span<const CutView> cuts,
                   std::string device) {
    FrameStats stats;
    stats.stages = {{"select", prepared.selectMs}, {"provide", provideMs}};
    tellCuts(cuts, stats);
    stats.away = stats.away || (prepared.sun && prepared.sun->cut.away);
    stats.nodesDamaged = countDamaged(cuts, prepared.sun);
    stats.mirrorsLeftOut = static_cast<std::uint32_t>(prepared.cuts.size() - cuts.size());
    stats.method = prepared.planned->method;
    stats.methodReason = prepared.planned->reason;
    stats.color = prepared.planned->colorName;
    stats.colormap = prepared.planned->colormap;
    stats.colorRange = prepared.planned->colorRange;
    stats.exposure = prepared.planned->exposure;
    stats.device = std::move(device);
    return stats;
}

/// The cuts as a device with memory of its own can draw them within its budget for a frame.
Expected<void> bringCuts(const Octree& octree, std::vector<CutView>& cuts, std::optional<CutView>& sun,
                         DeviceMemory& memory, const std::stop_token& stop) {
    std::vector<Cut*> all;
    for (CutView& view : cuts) all.push_back(&view.cut);
    if (sun) all.push_back(&sun->cut);
    return provideOnDevice(octree, all, memory, stop);
}

/// A picture as before there were mirrors; the statistics say so.
void leaveMirrorsOut(std::vector<CutView>& cuts) {
    cuts.resize(1);
    cuts.front().filter.dropped.clear();
}

/// A device's frame, and what the renderer knows of it.
class RenderedFrame final : public PendingFrame {
  public:
    RenderedFrame(std::unique_ptr<PendingFrame> pixels, FrameStats stats)
        : pixels_(std::move(pixels)), stats_(std::move(stats)) {}

    bool ready() override { return pixels_->ready(); }
    Expected<Frame> finish() override {
        auto frame = pixels_->finish();
        if (!frame) return frame;
        stats_.stages.insert(stats_.stages.end(), frame->stats.stages.begin(), frame->stats.stages.end());
        stats_.bytesUploaded = frame->stats.bytesUploaded;
        stats_.deviceBytes = frame->stats.deviceBytes;
        frame->stats = std::move(stats_);
        return frame;
    }

  private:
    std::unique_ptr<PendingFrame> pixels_;
    FrameStats stats_;
};

/// What does not depend on the device: all but the cuts.
Drawing drawingOf(const PreparedView& prepared, std::span<const glm::dvec2> jitter) {
    const PlannedView& planned = *prepared.planned;
    Drawing drawing;
    drawing.surfels = prepared.cloud->surfels;
    drawing.oriented = prepared.cloud->oriented;
    drawing.orientedNodes = prepared.cloud->sides.has_value();
    drawing.curvatures = planned.curvatures;
    drawing.passes = planned.passes;
    drawing.color = planned.color;
    drawing.background = planned.view.style.background;
    drawing.jitter = jitter;
    drawing.depth = prepared.depth;
    return drawing;
}

}  // namespace

std::optional<std::uint64_t> mostSamplesOn(Device& device) {
    const DeviceMemory* const memory = device.memory();
    if (!memory) return std::nullopt;
    return std::max<std::uint64_t>(memory->capacity() / 4 * 3, 1);
}

Expected<std::unique_ptr<PendingFrame>> beginDrawing(Device& device, const PreparedView& prepared,
                                                     std::stop_token stop, Uploads uploads,
                                                     const Pause* pause) {
    const PlannedView& planned = *prepared.planned;
    const auto jitter = jitterSequence(planned.view.quality.samples.value_or(defaultSamples));
    const DeviceInfo info = device.info();
    DeviceMemory* const memory = uploads == Uploads::ForAFrame ? device.memory() : nullptr;
    std::vector<CutView> own;  // where the device draws others than were prepared
    if (memory || !info.mirrors) own = prepared.cuts;
    std::optional<CutView> sun = prepared.sun;
    double provideMs = prepared.provideMs;
    if (memory) {
        const auto start = Clock::now();
        if (auto ok = bringCuts(octreeOf(*prepared.cloud, planned), own, sun, *memory, stop); !ok)
            return passOn(ok);
        provideMs += millisecondsSince(start);
    }
    if (!info.mirrors) leaveMirrorsOut(own);
    Drawing drawing = drawingOf(prepared, jitter);
    drawing.cuts = own.empty() ? prepared.cuts : own;
    if (sun) drawing.sun = &*sun;
    drawing.pause = pause;
    auto pixels =
        beginPicture(device, drawing, {prepared.tileSide, planned.margin, planned.tilesAreExact}, stop);
    if (!pixels) return pixels;
    return std::make_unique<RenderedFrame>(std::move(*pixels),
                                           statsOf(prepared, provideMs, drawing.cuts, info.name));
}

Expected<Frame> draw(Device& device, const PreparedView& prepared, std::stop_token stop, Uploads uploads) {
    auto begun = beginDrawing(device, prepared, std::move(stop), uploads);
    if (!begun) return passOn(std::move(begun));
    return (*begun)->finish();
}

}  // namespace scancast
