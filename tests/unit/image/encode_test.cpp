#include "renderer/image/encode.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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
