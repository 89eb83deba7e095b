#include "client/cpp/decode.hpp"

#include <gtest/gtest.h>

#include "renderer/image/encode.hpp"

namespace scancast::client {
namespace {

// Oracle: the server's own decoder.
TEST(Decode, PixelsAreThoseOfTheServersDecoder) {
    Frame frame;
    frame.width = 37;
    frame.height = 21;
    for (int i = 0; i < 37 * 21; ++i)
        for (const int value : {i % 256, i / 4 % 256, 255 - i % 200, 255})
            frame.rgba.own().push_back(static_cast<std::uint8_t>(value));
    const auto jpeg = encodeJpeg(frame, 90, Subsampling::S444);
    ASSERT_TRUE(jpeg);
    const auto truth = scancast::decodeJpeg(*jpeg);
    const auto pixels = client::decodeJpeg(*jpeg);
    ASSERT_TRUE(truth && pixels);
    EXPECT_EQ(pixels->width, 37);
    EXPECT_EQ(pixels->height, 21);
    ASSERT_EQ(pixels->rgb.size(), 37U * 21 * 3);
    for (std::size_t i = 0; i < 37U * 21; ++i)
        for (std::size_t channel = 0; channel < 3; ++channel)
            ASSERT_EQ(pixels->rgb[i * 3 + channel], truth->rgba[i * 4 + channel]) << i;
}

TEST(Decode, MorePixelsThanAreAcceptedAreRefusedByTheHead) {
    Frame frame;
    frame.width = 64;
    frame.height = 32;
    frame.rgba.own().assign(64 * 32 * 4, 200);
    auto jpeg = encodeJpeg(frame, 90, Subsampling::S444);
    ASSERT_TRUE(jpeg);
    EXPECT_TRUE(client::decodeJpeg(*jpeg, 64 * 32));
    const auto refused = client::decodeJpeg(*jpeg, 64 * 32 - 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::ResourceLimit);
    EXPECT_EQ(refused.error().message,
              "the JPEG picture has 64 x 32 pixels, and no more than 2047 are accepted");
}

TEST(Decode, WhatIsNoPictureIsAnError) {
    const std::vector<std::uint8_t> nothing, text{'n', 'o'};
    EXPECT_EQ(client::decodeJpeg(nothing).error().code, ErrorCode::Malformed);
    EXPECT_EQ(client::decodeJpeg(text).error().code, ErrorCode::Malformed);
}

}  // namespace
}  // namespace scancast::client
