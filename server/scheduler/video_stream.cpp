#include "server/scheduler/video_stream.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace scancast {

// JPEG's steps are `scale` times those of the standard's tables (libjpeg's rule), H.264's double with every sixth QP.
int quantiserFor(int jpegQuality) {
    constexpr double atHalf = 35, perDoubling = 5;
    const double quality = std::clamp(jpegQuality, 1, 100);
    const double scale = quality < 50 ? 50 / quality : 2 - quality / 50;
    constexpr int least = 10, most = 48;
    return std::clamp(int(std::lround(atHalf + perDoubling * std::log2(std::max(scale, 0.02)))), least, most);
}

VideoStream::VideoStream(TransientMemory memory, std::shared_ptr<const void> place)
    : memory_(std::move(memory)), place_(std::move(place)), held_(memory_.hold(MemoryUse::Video)) {}

bool VideoStream::prepareFor(int width, int height) {
    if (encoder_ && encoder_->width() == width && encoder_->height() == height) return true;
    encoder_.reset();
    held_.resize(0);
    if (!VideoEncoder::takes(width, height)) return false;
    const std::uint64_t bytes = VideoEncoder::bytesFor(width, height);
    if (memory_.bytes(MemoryUse::Video) + bytes > memory_.forVideo()) return false;
    held_.resize(bytes);
    auto opened = VideoEncoder::open(width, height);
    if (opened) {
        encoder_ = std::move(*opened);
        return true;
    }
    held_.resize(0);
    failed_ = true;
    spdlog::warn("a session's moving frames go on as JPEG: {}", opened.error().message);
    return false;
}

std::optional<VideoStream::Coded> VideoStream::encode(const Frame& frame, int jpegQuality) {
    const std::lock_guard lock(mutex_);
    if (failed_ || !prepareFor(frame.width, frame.height)) return std::nullopt;
    const bool key = keyWanted_.exchange(false);
    auto picture = encoder_->encode({frame.rgba.data(), frame.rgba.size()}, quantiserFor(jpegQuality), key);
    if (!picture) {
        failed_ = true;
        encoder_.reset();
        held_.resize(0);
        spdlog::warn("a session's moving frames go on as JPEG: {}", picture.error().message);
        return std::nullopt;
    }
    return Coded{std::move(picture->bytes), ++encoded_, picture->key};
}

}  // namespace scancast
