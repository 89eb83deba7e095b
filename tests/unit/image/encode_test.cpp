#include "renderer/image/encode.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "renderer/image/jpeg_stripes.hpp"

namespace scancast {
namespace {

/// A smooth picture with every channel different, so that swapped channels or rows show.
Frame gradient(int width, int height) {
    Frame frame{width, height, {}, {}, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            frame.rgba.own().push_back(static_cast<std::uint8_t>(255 * x / width));
            frame.rgba.own().push_back(static_cast<std::uint8_t>(255 * y / height));
            frame.rgba.own().push_back(static_cast<std::uint8_t>(255 - 255 * x / width));
            frame.rgba.own().push_back(static_cast<std::uint8_t>(x % 2 ? 255 : 7));
        }
    }
    return frame;
}

TEST(Png, RoundTripIsExactWithAlpha) {
    const Frame frame = gradient(37, 23);
    const auto bytes = encodePng(frame, true);
    ASSERT_TRUE(bytes);
    const auto back = decodePng(*bytes);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->rgba, frame.rgba);
}

TEST(Png, WithoutAlphaIsOpaque) {
    const Frame frame = gradient(5, 4);
    const auto bytes = encodePng(frame, false);
    ASSERT_TRUE(bytes);
    const auto back = decodePng(*bytes);
    ASSERT_TRUE(back);
    for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
        EXPECT_EQ(back->rgba[i], i % 4 == 3 ? 255 : frame.rgba[i]) << i;
    }
}

TEST(Jpeg, SmoothPictureComesBackNearlyEqual) {
    const Frame frame = gradient(64, 48);
    for (const auto subsampling : {Subsampling::S444, Subsampling::S422, Subsampling::S420}) {
        const auto bytes = encodeJpeg(frame, 95, subsampling);
        ASSERT_TRUE(bytes);
        const auto back = decodeJpeg(*bytes);
        ASSERT_TRUE(back);
        ASSERT_EQ(back->width, 64);
        ASSERT_EQ(back->height, 48);
        double worst = 0;
        for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
            if (i % 4 != 3)
                worst = std::max(worst, std::abs(static_cast<double>(frame.rgba[i]) - back->rgba[i]));
        }
        EXPECT_LE(worst, 16);
    }
}

TEST(Jpeg, SameFrameSameBytes) {
    const Frame frame = gradient(64, 48);
    EXPECT_EQ(*encodeJpeg(frame, 90, Subsampling::S420), *encodeJpeg(frame, 90, Subsampling::S420));
    EXPECT_NE(*encodeJpeg(frame, 90, Subsampling::S420), *encodeJpeg(frame, 40, Subsampling::S420));
}

/// What differs from pixel to pixel, so that every block has all of its coefficients.
Frame noisy(int width, int height) {
    Frame frame = gradient(width, height);
    std::mt19937 random(7);
    for (std::uint8_t& value : frame.rgba.own())
        value = static_cast<std::uint8_t>((value + random() % 64) & 255);
    return frame;
}

/// The library's own bytes of the whole picture.
Bytes inOnePiece(const Frame& frame, int quality, int subsampling) {
    const std::unique_ptr<void, int (*)(void*)> encoder(tjInitCompress(), tjDestroy);
    unsigned char* raw = nullptr;
    unsigned long size = 0;
    EXPECT_EQ(tjCompress2(encoder.get(), frame.rgba.data(), frame.width, 0, frame.height, TJPF_RGBX, &raw,
                          &size, subsampling, quality, 0),
              0);
    const std::unique_ptr<unsigned char, void (*)(unsigned char*)> buffer(raw, tjFree);
    return Bytes(raw, raw + size);
}

// Right because a restart changes how coefficients are written and not which: the pixels are those of the picture that the library
// writes in one piece.
TEST(Jpeg, InStripesItHasThePixelsOfOnePiece) {
    for (const auto& [ours, library] : {std::pair{Subsampling::S444, TJSAMP_444},
                                        {Subsampling::S422, TJSAMP_422},
                                        {Subsampling::S420, TJSAMP_420}}) {
        for (const auto& [width, height] :
             {std::pair{64, 64}, {65, 65}, {333, 127}, {17, 128}, {200, 129}, {1, 1000}, {1201, 719}}) {
            const Frame frame = noisy(width, height);
            const auto bytes = encodeJpeg(frame, 90, ours);
            ASSERT_TRUE(bytes);
            const auto back = decodeJpeg(*bytes), whole = decodeJpeg(inOnePiece(frame, 90, library));
            ASSERT_TRUE(back && whole);
            EXPECT_EQ(back->height, height);
            EXPECT_EQ(back->rgba, whole->rgba) << width << " x " << height;
            for (const int threads : {2, 3, 16})
                EXPECT_EQ(*encodeJpeg(frame, 90, ours, threads), *bytes) << threads;
        }
    }
}

TEST(Jpeg, TheWidestPictureHasStripes) {
    const Frame frame = noisy(maxPictureSide, 65);
    const auto bytes = encodeJpeg(frame, 30, Subsampling::S444);
    ASSERT_TRUE(bytes);
    const auto back = decodeJpeg(*bytes);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->rgba, decodeJpeg(inOnePiece(frame, 30, TJSAMP_444))->rgba);
}

TEST(Jpeg, WhatIsNoPictureIsNotJoined) {
    const auto good = *encodeJpeg(noisy(32, 64), 90, Subsampling::S420);
    for (const std::size_t keep :
         {std::size_t(0), std::size_t(1), std::size_t(30), good.size() / 2, good.size() - 1}) {
        const std::array<std::span<const std::uint8_t>, 2> stripes{std::span(good),
                                                                   std::span(good).first(keep)};
        EXPECT_FALSE(joinJpegStripes(stripes, 128, 64)) << keep;
        const std::array<std::span<const std::uint8_t>, 2> turned{stripes[1], stripes[0]};
        EXPECT_FALSE(joinJpegStripes(turned, 128, 64)) << keep;
    }
    EXPECT_FALSE(joinJpegStripes({}, 64, 64));
    const std::array<std::span<const std::uint8_t>, 2> both{std::span(good), std::span(good)};
    EXPECT_FALSE(joinJpegStripes(both, 80, 40)) << "rows that end within a block";
}

TEST(Jpeg, QualityOutOfRangeNamesTheWord) {
    const auto bytes = encodeJpeg(gradient(8, 8), 0, Subsampling::S420);
    ASSERT_FALSE(bytes);
    EXPECT_EQ(bytes.error().field, "quality");
}

TEST(Decode, DamagedBytesAreErrors) {
    auto jpeg = *encodeJpeg(gradient(64, 48), 90, Subsampling::S420);
    auto png = *encodePng(gradient(64, 48), true);
    for (const std::size_t keep : {std::size_t(0), std::size_t(3), std::size_t(20), png.size() / 2}) {
        EXPECT_FALSE(decodePng(std::span(png).first(keep))) << keep;
    }
    for (const std::size_t keep : {std::size_t(0), std::size_t(3), std::size_t(20)}) {
        EXPECT_FALSE(decodeJpeg(std::span(jpeg).first(keep))) << keep;
    }
}

TEST(Encode, AFrameWithoutPixelsIsRefused) {
    EXPECT_FALSE(encodeJpeg(Frame{}, 90, Subsampling::S420));
    EXPECT_FALSE(encodePng(Frame{4, 4, {1, 2, 3}, {}, {}}, true));
}

}  // namespace
}  // namespace scancast
