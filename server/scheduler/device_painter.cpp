#include <utility>

#include "renderer/render.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {
namespace {

/// Keeps the device for as long as it has a picture to finish.
class PaintedFrame final : public PendingFrame {
  public:
    PaintedFrame(std::shared_ptr<Device> device, std::unique_ptr<PendingFrame> frame)
        : device_(std::move(device)), frame_(std::move(frame)) {}
    bool ready() override { return frame_->ready(); }
    Expected<Frame> finish() override { return frame_->finish(); }

  private:
    std::shared_ptr<Device> device_;
    std::unique_ptr<PendingFrame> frame_;
};

/// Once for each order: who ordered may know, and a second turn does.
Expected<std::shared_ptr<const PlannedView>> planOf(const PictureOrder& order) {
    if (order.planned && order.planned->view == order.view) return order.planned;
    return plan(*order.cloud, order.view);
}

/// `most`: what the device can draw at once.
Expected<PreparedPicture> preparePicture(const PictureOrder& order, bool wait, std::stop_token stop,
                                         std::optional<std::uint64_t> most) {
    auto planned = planOf(order);
    if (!planned) return passOn(std::move(planned));
    RenderOptions options{.wait = wait, .requester = order.requester, .ahead = order.ahead};
    if (!order.complete) options.mostSamples = most;
    options.depth = order.withDepth || order.format == PictureFormat::Depth;
    auto prepared = prepare(*order.cloud, *planned, options, std::move(stop));
    if (!prepared) return passOn(std::move(prepared));
    const bool complete = samplesMissing(**prepared) == 0;
    return PreparedPicture{std::move(*prepared), complete, std::move(*planned)};
}

}  // namespace

OpenPainter painterWith(OpenDevice openDevice, OpenPainter instead) {
    return [openDevice = std::move(openDevice), instead = std::move(instead)]() -> Expected<Painter> {
        auto opened = openDevice();
        if (!opened) return passOn(std::move(opened));
        const std::shared_ptr<Device> device = std::move(*opened);
        Painter painter;
        painter.device = device->info();
        painter.prepare = [most = mostSamplesOn(*device)](const PictureOrder& order, bool wait,
                                                          std::stop_token stop) {
            return preparePicture(order, wait, std::move(stop), most);
        };
        // A moving frame is not cut into tiles for the sake of others.
        painter.begin = [device, pauses = painter.device.pauses](
                            const PictureOrder& order, const PreparedPicture& prepared, std::stop_token stop,
                            const Pause& pause) -> Expected<std::unique_ptr<PendingFrame>> {
            auto begun = beginDrawing(*device, *prepared.view, std::move(stop),
                                      order.complete ? Uploads::Everything : Uploads::ForAFrame,
                                      order.complete || pauses ? &pause : nullptr);
            if (!begun) return begun;
            return std::make_unique<PaintedFrame>(device, std::move(*begun));
        };
        painter.instead = instead;
        return painter;
    };
}

OpenPainter devicePainter(const DeviceOptions& options) {
    DeviceOptions onCpu;
    onCpu.backend = "cpu";
    onCpu.threads = options.threads;
    const auto opens = [](const DeviceOptions& what) { return [what] { return createDevice(what); }; };
    if (options.backend == "cpu") return painterWith(opens(options));
    return painterWith(opens(options), painterWith(opens(onCpu)));
}

}  // namespace scancast
