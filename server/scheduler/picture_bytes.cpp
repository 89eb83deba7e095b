#include "server/scheduler/picture_bytes.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t rgba = 4, depth = 4;

struct PerPixel {
    double encodedAtMost = 0, encoded = 0;
};

PerPixel perPixel(const View& view, PictureFormat format) {
    switch (format) {
        case PictureFormat::Png:
            return view.style.background.kind == Background::Kind::Transparent ? PerPixel{4, 2}
                                                                               : PerPixel{3, 1.5};
        case PictureFormat::Depth:
        case PictureFormat::Pixels:
            return {4, 4};
        case PictureFormat::Jpeg:
            break;
    }
    return {1.5, 0.5};
}

}  // namespace

std::uint64_t bytesToDraw(const View& view, PictureFormat format) {
    const bool isDepth = format == PictureFormat::Depth;
    const bool isPlain = isDepth || format == PictureFormat::Pixels;
    // What libraries encode into is copied once; depth and pixels go out as they are.
    const double encoded = perPixel(view, format).encodedAtMost * (isPlain ? 1 : 2);
    return std::uint64_t(double(view.width) * view.height * (double(rgba + (isDepth ? depth : 0)) + encoded));
}

std::uint64_t bytesToDraw(const PictureOrder& order) {
    const bool drawsDepth = order.withDepth && order.format != PictureFormat::Depth;
    return bytesToDraw(order.view, order.format) +
           (drawsDepth ? std::uint64_t(order.view.width) * std::uint64_t(order.view.height) * depth : 0);
}

std::uint64_t bytesToKeep(const View& view, PictureFormat format) {
    return std::uint64_t(double(view.width) * view.height * perPixel(view, format).encoded);
}

}  // namespace scancast
