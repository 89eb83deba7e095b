#include "client/cpp/decode.hpp"

#include <turbojpeg.h>

#include <memory>

#include "protocol/view/view.hpp"

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

}  // namespace scancast::client
