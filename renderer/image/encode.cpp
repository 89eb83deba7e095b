#include "renderer/image/encode.hpp"

#include <spng.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "renderer/image/jpeg_stripes.hpp"

namespace scancast {

namespace {

struct TurboDeleter {
    void operator()(void* handle) const { tjDestroy(handle); }
};
using Turbo = std::unique_ptr<void, TurboDeleter>;

struct TurboBufferDeleter {
    void operator()(unsigned char* buffer) const { tjFree(buffer); }
};

struct SpngDeleter {
    void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Spng = std::unique_ptr<spng_ctx, SpngDeleter>;

struct FreeDeleter {
    void operator()(void* memory) const { std::free(memory); }
};

int turboSubsampling(Subsampling subsampling) {
    switch (subsampling) {
        case Subsampling::S444:
            return TJSAMP_444;
        case Subsampling::S422:
            return TJSAMP_422;
        case Subsampling::S420:
            break;
    }
    return TJSAMP_420;
}

std::size_t pixelCount(const Frame& frame) {
    return static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
}

bool sound(const Frame& frame) {
    return frame.width > 0 && frame.height > 0 && frame.rgba.size() == pixelCount(frame) * 4;
}

tl::unexpected<Error> noMemory() {
    return fail(ErrorCode::ResourceLimit,
                "There is not enough memory to encode this picture; ask for a smaller one.");
}

/// Of compressing a sound frame: there is nothing else that it fails for at run time.
tl::unexpected<Error> jpegFailure(void* encoder) {
    const std::string reason = tjGetErrorStr2(encoder);
    if (reason.find("emory") != std::string::npos) return noMemory();
    return fail(ErrorCode::Internal, "JPEG: " + reason);
}

tl::unexpected<Error> pngFailure(ErrorCode code, int status) {
    if (code == ErrorCode::Internal && status == SPNG_EMEM) return noMemory();
    return fail(code, std::string("PNG: ") + spng_strerror(status));
}

/// A few rows, as a picture of their own.
struct JpegStripe {
    std::unique_ptr<unsigned char, TurboBufferDeleter> buffer;
    std::size_t size = 0;
};

Expected<JpegStripe> encodeStripe(const std::uint8_t* rgba, int width, int rows, int quality,
                                  Subsampling subsampling) {
    const Turbo encoder(tjInitCompress());
    if (!encoder) return fail(ErrorCode::Internal, std::string("JPEG: ") + tjGetErrorStr2(nullptr));
    unsigned char* raw = nullptr;
    unsigned long size = 0;
    const int failed = tjCompress2(encoder.get(), rgba, width, 0, rows, TJPF_RGBX, &raw, &size,
                                   turboSubsampling(subsampling), quality, 0);
    JpegStripe stripe{std::unique_ptr<unsigned char, TurboBufferDeleter>(raw), size};
    if (failed) return jpegFailure(encoder.get());
    return stripe;
}

/// A decoder must not be made to allocate what a few hostile bytes promise.
constexpr std::uint64_t maxDecodedPixels = std::uint64_t(maxPictureSide) * maxPictureSide;

}  // namespace

Expected<Bytes> encodeJpeg(const Frame& frame, int quality, Subsampling subsampling, int threads) {
    if (!sound(frame)) return fail(ErrorCode::Internal, "JPEG: the frame has no pixels");
    if (quality < 1 || quality > 100) {
        return fail(ErrorCode::InvalidArgument, "quality must be from 1 (small) to 100 (fine)", "quality");
    }
    const int count = (frame.height + jpegStripeRows - 1) / jpegStripeRows;
    std::vector<Expected<JpegStripe>> stripes(static_cast<std::size_t>(count));
    const auto encode = [&](int i) {
        const int y0 = i * jpegStripeRows, rows = std::min(jpegStripeRows, frame.height - y0);
        const auto* const pixels = frame.rgba.data() + std::size_t(y0) * std::size_t(frame.width) * 4;
        stripes[std::size_t(i)] = encodeStripe(pixels, frame.width, rows, quality, subsampling);
    };
    if (threads == 0) threads = tbb::this_task_arena::max_concurrency();
    if (threads < 2 || count < 2) {
        for (int i = 0; i < count; ++i) encode(i);
    } else {
        tbb::task_arena(std::min(threads, count)).execute([&] {
            tbb::parallel_for(0, count, encode, tbb::simple_partitioner());
        });
    }
    std::vector<std::span<const std::uint8_t>> pictures;
    for (const auto& stripe : stripes) {
        if (!stripe) return tl::unexpected(stripe.error());
        pictures.emplace_back(stripe->buffer.get(), stripe->size);
    }
    return joinJpegStripes(pictures, frame.height, jpegStripeRows);
}

Expected<Bytes> encodePng(const Frame& frame, bool alpha, const std::stop_token& stop) {
    if (!sound(frame)) return fail(ErrorCode::Internal, "PNG: the frame has no pixels");
    const Spng encoder(spng_ctx_new(SPNG_CTX_ENCODER));
    if (!encoder) return fail(ErrorCode::ResourceLimit, "PNG: out of memory");
    spng_set_option(encoder.get(), SPNG_ENCODE_TO_BUFFER, 1);
    // Level 3 with the up filter: pictures of points hardly compress further, and cost four times as long.
    spng_set_option(encoder.get(), SPNG_IMG_COMPRESSION_LEVEL, 3);
    spng_set_option(encoder.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_UP);
    spng_ihdr header{};
    header.width = static_cast<std::uint32_t>(frame.width);
    header.height = static_cast<std::uint32_t>(frame.height);
    header.bit_depth = 8;
    header.color_type = alpha ? SPNG_COLOR_TYPE_TRUECOLOR_ALPHA : SPNG_COLOR_TYPE_TRUECOLOR;
    if (const int status = spng_set_ihdr(encoder.get(), &header))
        return pngFailure(ErrorCode::Internal, status);

    int status = spng_encode_image(encoder.get(), nullptr, 0, SPNG_FMT_PNG,
                                   SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE);
    const std::size_t width = header.width;
    Bytes rgb(alpha ? 0 : width * 3);
    for (int y = 0; y < frame.height && status == 0; ++y) {
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        std::span<const std::uint8_t> row(frame.rgba.data() + static_cast<std::size_t>(y) * width * 4,
                                          width * 4);
        for (std::size_t x = 0; x < width && !alpha; ++x)
            std::copy_n(row.data() + 4 * x, 3, rgb.data() + 3 * x);
        if (!alpha) row = rgb;
        status = spng_encode_scanline(encoder.get(), row.data(), row.size());
    }
    if (status != SPNG_EOI) return pngFailure(ErrorCode::Internal, status);
    std::size_t size = 0;
    const std::unique_ptr<void, FreeDeleter> buffer(spng_get_png_buffer(encoder.get(), &size, &status));
    if (!buffer) return pngFailure(ErrorCode::Internal, status);
    const auto* begin = static_cast<const std::uint8_t*>(buffer.get());
    return Bytes(begin, begin + size);
}

Expected<Frame> decodeJpeg(std::span<const std::uint8_t> bytes) {
    const Turbo decoder(tjInitDecompress());
    if (!decoder) return fail(ErrorCode::Internal, std::string("JPEG: ") + tjGetErrorStr2(nullptr));
    Frame frame;
    int subsampling = 0, colorSpace = 0;
    if (tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &frame.width, &frame.height,
                            &subsampling, &colorSpace) ||
        pixelCount(frame) > maxDecodedPixels) {
        return fail(ErrorCode::Malformed,
                    std::string("not a JPEG picture: ") + tjGetErrorStr2(decoder.get()));
    }
    frame.rgba.own().resize(pixelCount(frame) * 4);
    if (tjDecompress2(decoder.get(), bytes.data(), bytes.size(), frame.rgba.own().data(), frame.width, 0,
                      frame.height, TJPF_RGBA, 0)) {
        return fail(ErrorCode::Truncated,
                    std::string("damaged JPEG picture: ") + tjGetErrorStr2(decoder.get()));
    }
    return frame;
}

Expected<Frame> decodePng(std::span<const std::uint8_t> bytes) {
    const Spng decoder(spng_ctx_new(0));
    if (!decoder) return fail(ErrorCode::ResourceLimit, "PNG: out of memory");
    spng_set_image_limits(decoder.get(), maxPictureSide, maxPictureSide);
    if (const int status = spng_set_png_buffer(decoder.get(), bytes.data(), bytes.size())) {
        return pngFailure(ErrorCode::Malformed, status);
    }
    spng_ihdr header{};
    if (const int status = spng_get_ihdr(decoder.get(), &header))
        return pngFailure(ErrorCode::Malformed, status);
    Frame frame;
    frame.width = static_cast<int>(header.width);
    frame.height = static_cast<int>(header.height);
    frame.rgba.own().resize(pixelCount(frame) * 4);
    if (const int status = spng_decode_image(decoder.get(), frame.rgba.own().data(), frame.rgba.size(),
                                             SPNG_FMT_RGBA8, SPNG_DECODE_TRNS)) {
        return pngFailure(ErrorCode::Truncated, status);
    }
    return frame;
}

}  // namespace scancast
