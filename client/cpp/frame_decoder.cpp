#include "client/cpp/frame_decoder.hpp"

#include <string>
#include <utility>

#include "video/openh264.hpp"
#include "video/video_decoder.hpp"

namespace scancast::client {

std::vector<Codec> readableCodecs() {
    if (openH264()) return {Codec::H264, Codec::Jpeg};
    return {Codec::Jpeg};
}

Expected<void> canReadVideo() {
    if (auto library = openH264(); !library) return passOn(std::move(library));
    return {};
}

FrameDecoder::FrameDecoder() = default;
FrameDecoder::~FrameDecoder() = default;
FrameDecoder::FrameDecoder(FrameDecoder&&) noexcept = default;
FrameDecoder& FrameDecoder::operator=(FrameDecoder&&) noexcept = default;

Expected<Pixels> FrameDecoder::decode(const ReceivedFrame& frame, std::size_t mostPixels) {
    if (frame.header.codec == Codec::Jpeg) return decodeJpeg(frame.jpeg, mostPixels);
    auto pixels = decodeVideo(frame, mostPixels);
    if (!pixels) video_.reset();  // whatever it holds, the next key does not need it
    return pixels;
}

Expected<Pixels> FrameDecoder::decodeVideo(const ReceivedFrame& frame, std::size_t mostPixels) {
    const std::size_t count = std::size_t(frame.header.width) * frame.header.height;
    if (count > mostPixels)
        return fail(ErrorCode::ResourceLimit,
                    "the video's picture has " + std::to_string(frame.header.width) + " x " +
                        std::to_string(frame.header.height) + " pixels, and no more than " +
                        std::to_string(mostPixels) + " are accepted");
    if (!video_ && !frame.header.key)
        return fail(ErrorCode::Truncated, "the frame builds on one before it that could not be decoded");
    if (!video_) {
        auto opened = VideoDecoder::open();
        if (!opened) return passOn(std::move(opened));
        video_ = std::move(*opened);
    }
    auto rgb = video_->decode(frame.h264, int(frame.header.width), int(frame.header.height));
    if (!rgb) return passOn(std::move(rgb));
    return Pixels{int(frame.header.width), int(frame.header.height), std::move(*rgb)};
}

}  // namespace scancast::client
