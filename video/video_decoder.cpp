#include "video/video_decoder.hpp"

#include <turbojpeg.h>
#include <wels/codec_api.h>

#include <array>
#include <string>

#include "video/openh264.hpp"

namespace scancast {
namespace {

struct DestroyTurboPlanes {
    void operator()(void* handle) const { tjDestroy(handle); }
};

class OpenH264Decoder final : public VideoDecoder {
  public:
    explicit OpenH264Decoder(const OpenH264& library) : library_(library) {}
    ~OpenH264Decoder() override {
        if (decoder_ == nullptr) return;
        decoder_->Uninitialize();
        library_.destroyDecoder(decoder_);
    }
    OpenH264Decoder(const OpenH264Decoder&) = delete;
    OpenH264Decoder& operator=(const OpenH264Decoder&) = delete;

    Expected<void> start() {
        turbo_.reset(tjInitDecompress());
        if (!turbo_ || library_.createDecoder(&decoder_) != 0 || decoder_ == nullptr)
            return fail(ErrorCode::ResourceLimit, "There is not enough memory for a video decoder.");
        int quiet = WELS_LOG_QUIET;
        decoder_->SetOption(DECODER_OPTION_TRACE_LEVEL, &quiet);
        SDecodingParam parameters{};
        parameters.uiTargetDqLayer = 255;             // all that there is
        parameters.eEcActiveIdc = ERROR_CON_DISABLE;  // a picture that was guessed at is none
        parameters.sVideoProperty.eVideoBsType = VIDEO_BITSTREAM_AVC;
        if (const long code = decoder_->Initialize(&parameters); code != 0)
            return fail(ErrorCode::Internal,
                        "OpenH264 does not start (its code " + std::to_string(code) + ")");
        return {};
    }

    Expected<std::vector<std::uint8_t>> decode(std::span<const std::uint8_t> accessUnit, int width,
                                               int height) override {
        constexpr std::size_t longest = 1 << 28;
        if (accessUnit.empty() || accessUnit.size() > longest || width < 1 || height < 1)
            return fail(ErrorCode::Malformed, "the frame holds no picture of a video");
        std::array<unsigned char*, 3> planes{};
        SBufferInfo info{};
        const auto state =
            decoder_->DecodeFrameNoDelay(accessUnit.data(), int(accessUnit.size()), planes.data(), &info);
        if (state != dsErrorFree || info.iBufferStatus != 1)
            return fail(ErrorCode::Truncated,
                        "the video is damaged, or lacks the frame that this one builds on (OpenH264's code " +
                            std::to_string(int(state)) + ")");
        const SSysMEMBuffer& picture = info.UsrData.sSystemBuffer;
        if (picture.iWidth != (width + 1) / 2 * 2 || picture.iHeight != (height + 1) / 2 * 2 ||
            picture.iFormat != videoFormatI420)
            return fail(ErrorCode::Malformed, "the video's picture has " + std::to_string(picture.iWidth) +
                                                  " x " + std::to_string(picture.iHeight) +
                                                  " px, the frame " + std::to_string(width) + " x " +
                                                  std::to_string(height));
        std::array<int, 3> strides{picture.iStride[0], picture.iStride[1], picture.iStride[1]};
        std::array<const unsigned char*, 3> source{planes[0], planes[1], planes[2]};
        std::vector<std::uint8_t> rgb(std::size_t(width) * std::size_t(height) * 3);
        if (tjDecodeYUVPlanes(turbo_.get(), source.data(), strides.data(), TJSAMP_420, rgb.data(), width, 0,
                              height, TJPF_RGB, 0) != 0)
            return fail(ErrorCode::Internal,
                        std::string("a picture of the video: ") + tjGetErrorStr2(turbo_.get()));
        return rgb;
    }

  private:
    const OpenH264& library_;
    std::unique_ptr<void, DestroyTurboPlanes> turbo_;
    ISVCDecoder* decoder_ = nullptr;
};

}  // namespace

Expected<std::unique_ptr<VideoDecoder>> VideoDecoder::open() {
    const auto library = openH264();
    if (!library) return passOn(library);
    auto decoder = std::make_unique<OpenH264Decoder>(**library);
    if (auto ok = decoder->start(); !ok) return passOn(ok);
    return decoder;
}

}  // namespace scancast
