#include "video/video_encoder.hpp"

#include <turbojpeg.h>
#include <wels/codec_api.h>

#include <algorithm>
#include <array>
#include <string>

#include "video/openh264.hpp"

namespace scancast {
namespace {

constexpr int leastSide = 16;
constexpr std::int64_t mostPixels = 4096 * 2304;  // of level 5.2, the highest that OpenH264 writes
constexpr int longestSide = 4096;
constexpr int leastQuantiser = 1, mostQuantiser = 51;
constexpr float nominalRate = 60;  // decides the level, nothing else: rates are the session's

// Rec. ITU-T H.264, annex E: what JPEG's pixels are.
constexpr unsigned char unspecifiedFormat = 5, primariesOfSrgb = 1, transferOfSrgb = 13, matrixOfBt601 = 6;

struct DestroyTurboVideo {
    void operator()(void* handle) const { tjDestroy(handle); }
};

int evenSide(int side) {
    return (side + 1) / 2 * 2;
}

tl::unexpected<Error> encoderRefuses(const char* what, int code) {
    return fail(ErrorCode::Internal,
                std::string("OpenH264 does not ") + what + " (its code " + std::to_string(code) + ")");
}

class OpenH264Encoder final : public VideoEncoder {
  public:
    OpenH264Encoder(const OpenH264& library, int width, int height)
        : library_(library),
          width_(width),
          height_(height),
          planes_(std::size_t(evenSide(width)) * std::size_t(evenSide(height)) * 3 / 2) {}

    ~OpenH264Encoder() override {
        if (encoder_ == nullptr) return;
        encoder_->Uninitialize();
        library_.destroyEncoder(encoder_);
    }
    OpenH264Encoder(const OpenH264Encoder&) = delete;
    OpenH264Encoder& operator=(const OpenH264Encoder&) = delete;

    Expected<void> start() {
        turbo_.reset(tjInitCompress());
        if (!turbo_ || library_.createEncoder(&encoder_) != 0 || encoder_ == nullptr)
            return fail(ErrorCode::ResourceLimit, "There is not enough memory for a video encoder.");
        int quiet = WELS_LOG_QUIET;
        encoder_->SetOption(ENCODER_OPTION_TRACE_LEVEL, &quiet);
        encoder_->GetDefaultParams(&parameters_);
        describe(parameters_);
        if (const int code = encoder_->InitializeExt(&parameters_); code != cmResultSuccess)
            return encoderRefuses("take this size", code);
        int format = videoFormatI420;
        encoder_->SetOption(ENCODER_OPTION_DATAFORMAT, &format);
        return {};
    }

    int width() const override { return width_; }
    int height() const override { return height_; }

    Expected<VideoPicture> encode(std::span<const std::uint8_t> rgba, int quantiser, bool key) override {
        if (rgba.size() != std::size_t(width_) * std::size_t(height_) * 4)
            return fail(ErrorCode::Internal, "the picture is not of the size that its video has");
        if (auto ok = setQuantiser(std::clamp(quantiser, leastQuantiser, mostQuantiser)); !ok)
            return passOn(ok);
        SSourcePicture source{};
        if (auto ok = convert(rgba, source); !ok) return passOn(ok);
        if (key) encoder_->ForceIntraFrame(true);
        SFrameBSInfo coded{};
        if (const int code = encoder_->EncodeFrame(&source, &coded); code != cmResultSuccess)
            return encoderRefuses("encode a picture", code);
        VideoPicture picture;
        picture.key = coded.eFrameType == videoFrameTypeIDR;
        picture.bytes = bytesOf(coded);
        if (picture.bytes.empty()) return encoderRefuses("give a picture's bytes", coded.eFrameType);
        return picture;
    }

  private:
    void describe(SEncParamExt& all) const {
        const int width = evenSide(width_), height = evenSide(height_);
        all.iUsageType = CAMERA_VIDEO_REAL_TIME;
        all.iPicWidth = width;
        all.iPicHeight = height;
        all.fMaxFrameRate = nominalRate;
        all.iRCMode = RC_OFF_MODE;  // what a picture may cost is the session's to say, which knows the line
        all.iComplexityMode = LOW_COMPLEXITY;
        all.iMultipleThreadIdc = 1;
        all.uiIntraPeriod = 0;
        all.iNumRefFrame = 1;
        all.eSpsPpsIdStrategy = CONSTANT_ID;
        all.iEntropyCodingModeFlag = 0;
        // Nothing may be left out, and every picture is looked at as it is.
        all.bEnableFrameSkip = false;
        all.bEnableSceneChangeDetect = false;
        all.bEnableBackgroundDetection = false;
        all.bEnableAdaptiveQuant = false;
        all.bEnableDenoise = false;
        SSpatialLayerConfig& layer = all.sSpatialLayers[0];
        layer.iVideoWidth = width;
        layer.iVideoHeight = height;
        layer.fFrameRate = nominalRate;
        layer.iDLayerQp = quantiser_;
        layer.uiProfileIdc = PRO_BASELINE;
        layer.sSliceArgument.uiSliceMode = SM_SINGLE_SLICE;
        layer.bVideoSignalTypePresent = true;
        layer.uiVideoFormat = unspecifiedFormat;
        layer.bFullRange = true;
        layer.bColorDescriptionPresent = true;
        layer.uiColorPrimaries = primariesOfSrgb;
        layer.uiTransferCharacteristics = transferOfSrgb;
        layer.uiColorMatrix = matrixOfBt601;
    }

    Expected<void> setQuantiser(int quantiser) {
        if (quantiser == quantiser_) return {};
        parameters_.sSpatialLayers[0].iDLayerQp = quantiser;
        // Costs nothing and begins nothing anew: it is the size and the like that do.
        SEncParamExt changed = parameters_;
        if (const int code = encoder_->SetOption(ENCODER_OPTION_SVC_ENCODE_PARAM_EXT, &changed);
            code != cmResultSuccess)
            return encoderRefuses("take another quantiser", code);
        quantiser_ = quantiser;
        return {};
    }

    Expected<void> convert(std::span<const std::uint8_t> rgba, SSourcePicture& source) {
        const int width = evenSide(width_), height = evenSide(height_);
        const std::size_t luma = std::size_t(width) * std::size_t(height);
        std::array<unsigned char*, 3> planes{planes_.data(), planes_.data() + luma,
                                             planes_.data() + luma + luma / 4};
        std::array<int, 3> strides{width, width / 2, width / 2};
        if (tjEncodeYUVPlanes(turbo_.get(), rgba.data(), width_, 0, height_, TJPF_RGBX, planes.data(),
                              strides.data(), TJSAMP_420, TJFLAG_FASTDCT) != 0)
            return fail(ErrorCode::Internal,
                        std::string("a picture for the video: ") + tjGetErrorStr2(turbo_.get()));
        source.iColorFormat = videoFormatI420;
        source.iPicWidth = width;
        source.iPicHeight = height;
        source.uiTimeStamp = (time_ += 1000 / int(nominalRate));
        for (std::size_t i = 0; i < planes.size(); ++i) {
            source.pData[i] = planes[i];
            source.iStride[i] = strides[i];
        }
        return {};
    }

    static std::vector<std::uint8_t> bytesOf(const SFrameBSInfo& coded) {
        std::vector<std::uint8_t> bytes;
        for (int i = 0; i < coded.iLayerNum; ++i) {
            const SLayerBSInfo& layer = coded.sLayerInfo[i];
            std::size_t length = 0;
            for (int nal = 0; nal < layer.iNalCount; ++nal)
                length += std::size_t(layer.pNalLengthInByte[nal]);
            bytes.insert(bytes.end(), layer.pBsBuf, layer.pBsBuf + length);
        }
        return bytes;
    }

    const OpenH264& library_;
    const int width_, height_;
    std::vector<std::uint8_t> planes_;
    std::unique_ptr<void, DestroyTurboVideo> turbo_;
    ISVCEncoder* encoder_ = nullptr;
    SEncParamExt parameters_{};
    int quantiser_ = 26;
    long long time_ = 0;  // ms that the library is told; it need only grow
};

}  // namespace

bool VideoEncoder::takes(int width, int height) {
    return width >= leastSide && height >= leastSide && evenSide(width) <= longestSide &&
           evenSide(height) <= longestSide && std::int64_t(evenSide(width)) * evenSide(height) <= mostPixels;
}

std::uint64_t VideoEncoder::bytesFor(int width, int height) {
    constexpr std::uint64_t own = 2 << 20, perPixel = 14;
    return own + std::uint64_t(evenSide(width)) * std::uint64_t(evenSide(height)) * perPixel;
}

Expected<std::unique_ptr<VideoEncoder>> VideoEncoder::open(int width, int height) {
    if (!takes(width, height))
        return fail(ErrorCode::InvalidArgument, "no video has pictures of " + std::to_string(width) + " x " +
                                                    std::to_string(height) +
                                                    " px: it takes 16 x 16 to 4096 x 2304");
    const auto library = openH264();
    if (!library) return passOn(library);
    auto encoder = std::make_unique<OpenH264Encoder>(**library, width, height);
    if (auto ok = encoder->start(); !ok) return passOn(ok);
    return encoder;
}

}  // namespace scancast
