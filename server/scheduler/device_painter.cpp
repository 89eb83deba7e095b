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
        painter.prepare = [](const PictureOrder& order, bool wait,
                             std::stop_token stop) -> Expected<PreparedPicture> {
            auto prepared =
                prepare(*order.cloud, order.view,
                        {.wait = wait, .requester = order.requester, .ahead = order.ahead}, std::move(stop));
            if (!prepared) return tl::unexpected(std::move(prepared.error()));
            const bool complete = samplesMissing(**prepared) == 0;
            return PreparedPicture{std::move(*prepared), complete};
        };
        painter.paint = [device](const PictureOrder&, const PreparedPicture& prepared, std::stop_token stop) {
            return draw(*device, *prepared.view, std::move(stop));
        };
        return painter;
    };
}

}  // namespace scancast
