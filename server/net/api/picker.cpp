#include "server/net/api/picker.hpp"

#include <cmath>
#include <cstring>
#include <utility>

#include "server/base/faults.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/api/picture_request.hpp"

namespace scancast {
namespace {

constexpr std::size_t mostWaiting = 64;

double depthAt(const EncodedPicture& picture, const glm::ivec2& pixel) {
    const auto index = std::size_t(pixel.y) * std::size_t(picture.width) + std::size_t(pixel.x);
    float depth = 0;
    std::memcpy(&depth, picture.bytes->data() + index * sizeof depth, sizeof depth);
    return depth;
}

Error busy(std::string why) {
    return {ErrorCode::Cancelled, std::move(why), {}};
}

}  // namespace

Expected<glm::ivec2> pixelAt(const View& view, double x, double y) {
    const auto inside = [](double value, int size) { return value >= 0 && value < size; };
    if (!inside(x, view.width))
        return fail(ErrorCode::InvalidArgument,
                    "x: must lie in the picture, 0 to below " + std::to_string(view.width), "x");
    if (!inside(y, view.height)) {
        return fail(ErrorCode::InvalidArgument,
                    "y: must lie in the picture, 0 to below " + std::to_string(view.height), "y");
    }
    return glm::ivec2(int(std::floor(x)), int(std::floor(y)));
}

Picker::Picker(const SharedPictures& pictures, Scheduler& scheduler, std::string version)
    : pictures_(pictures), scheduler_(scheduler), version_(std::move(version)), worker_(mostWaiting) {}

Expected<void> Picker::pick(std::shared_ptr<const Cloud> cloud, std::shared_ptr<const PlannedView> asked,
                            double x, double y, PickDone done, const PickedFor& by) const {
    const auto pixel = pixelAt(asked->view, x, y);
    if (!pixel) return passOn(pixel);
    const View view = depthView(asked->view);
    const DeviceStatus device = scheduler_.device();
    if (device.state != DeviceStatus::State::Ready)
        return fail(ErrorCode::DeviceUnavailable, "The rendering device is not available.");
    const std::string tag = pictureTag(*cloud, view, PictureFormat::Depth, device.info, version_);
    PictureOrder order{cloud, view, PictureFormat::Depth, false};
    order.planned = std::move(asked);
    order.client = by.client;
    order.price = by.price;
    auto drawn = [this, cloud, view, pixel = *pixel, done](const Expected<EncodedPicture>& picture) {
        if (!picture) return done(tl::unexpected(picture.error()));
        const double depth = depthAt(*picture, pixel);
        const auto posted = contained("The queue of picks", [&] {
            return worker_.post([cloud, view, pixel, depth, done](const std::stop_token& stop) {
                auto picked =
                    contained("Picking", [&] { return scancast::pick(*cloud, view, pixel, depth, stop); });
                if (!stop.stop_requested()) done(std::move(picked));
            });
        });
        if (!posted) return done(tl::unexpected(posted.error()));
        if (!*posted) done(tl::unexpected(busy("Too many picks are waiting; try again in a moment.")));
    };
    if (auto queued = pictures_.order(tag, std::move(order), std::move(drawn), by.gone); !queued)
        return tl::unexpected(busy(queued.error().message));
    return {};
}

}  // namespace scancast
