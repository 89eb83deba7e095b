#include "client/cpp/decode.hpp"

#include <turbojpeg.h>

#include <memory>
#include <string>
#include <utility>

#include "client/cpp/stream.hpp"
#include "protocol/view/view.hpp"
#include "video/openh264.hpp"
#include "video/video_decoder.hpp"

namespace scancast::client {
namespace {

struct DestroyTurbo {
    void operator()(void* handle) const { tjDestroy(handle); }
};

}  // namespace

Expected<Pixels> decodeJpeg(std::span<const std::uint8_t> jpeg, std::size_t mostPixels) {
    const std::unique_ptr<void, DestroyTurbo> decoder(tjInitDecompress());
    if (!decoder) return fail(ErrorCode::Internal, std::string("JPEG: ") + tjGetErrorStr2(nullptr));
    Pixels pixels;
    int subsampling = 0, colorSpace = 0;
    if (tjDecompressHeader3(decoder.get(), jpeg.data(), jpeg.size(), &pixels.width, &pixels.height,
                            &subsampling, &colorSpace) ||
        pixels.width > maxPictureSide || pixels.height > maxPictureSide)
        return fail(ErrorCode::Malformed,
                    std::string("not a JPEG picture: ") + tjGetErrorStr2(decoder.get()));
    const auto count = static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height);
    if (count > mostPixels)
        return fail(ErrorCode::ResourceLimit, "the JPEG picture has " + std::to_string(pixels.width) + " x " +
                                                  std::to_string(pixels.height) +
                                                  " pixels, and no more than " + std::to_string(mostPixels) +
                                                  " are accepted");
    pixels.rgb.resize(count * 3);
    if (tjDecompress2(decoder.get(), jpeg.data(), jpeg.size(), pixels.rgb.data(), pixels.width, 0,
                      pixels.height, TJPF_RGB, 0))
        return fail(ErrorCode::Truncated,
                    std::string("damaged JPEG picture: ") + tjGetErrorStr2(decoder.get()));
    return pixels;
}

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
