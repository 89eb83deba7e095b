#include "server/scheduler/picture_order.hpp"

#include <bit>
#include <cstring>

#include "renderer/image/depth_cells.hpp"

namespace scancast {

static_assert(std::endian::native == std::endian::little, "depth goes out as it lies in memory");

Expected<Bytes> encodePicture(const Frame& frame, const View& view, PictureFormat format,
                              const std::stop_token& stop, int threads) {
    if (format == PictureFormat::Png) {
        return encodePng(frame, view.style.background.kind == Background::Kind::Transparent, stop);
    }
    if (format == PictureFormat::Depth) {
        Bytes bytes(frame.depth.size() * sizeof(float));
        std::memcpy(bytes.data(), frame.depth.data(), bytes.size());
        return bytes;
    }
    if (format == PictureFormat::Pixels) return Bytes(frame.rgba.begin(), frame.rgba.end());
    return encodeJpeg(frame, view.quality.jpegQuality, view.quality.subsampling, threads);
}

Expected<Bytes> encodeDepth(const Frame& frame) {
    if (frame.depth.size() != std::size_t(frame.width) * std::size_t(frame.height))
        return fail(ErrorCode::Internal, "the picture was to be drawn with its depth, and has none");
    return packDepth(depthCells(frame));
}

}  // namespace scancast
