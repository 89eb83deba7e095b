#include <utility>

#include "renderer/render.hpp"
#include "server/scheduler/picture.hpp"

namespace scancast {

OpenPainter devicePainter(const DeviceOptions& options) {
    return [options]() -> Expected<Painter> {
        auto opened = createDevice(options);
        if (!opened) return tl::unexpected(std::move(opened.error()));
        const std::shared_ptr<Device> device = std::move(*opened);
        Painter painter;
        painter.device = device->info();
        painter.paint = [device](const Cloud& cloud, const View& view, std::stop_token stop) {
            return render(*device, cloud, view, {}, std::move(stop));
        };
        return painter;
    };
}

}  // namespace scancast
