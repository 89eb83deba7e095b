#include "client/cpp/program/jpeg_facts.hpp"

#include <gtest/gtest.h>

#include "renderer/image/encode.hpp"

namespace scancast::client {
namespace {

Frame colourful(int width, int height) {
    Frame frame;
    frame.width = width;
    frame.height = height;
    std::vector<std::uint8_t>& rgba = frame.rgba.own();
    rgba.resize(static_cast<std::size_t>(width) * height * 4);
    for (std::size_t i = 0; i < rgba.size(); ++i) rgba[i] = static_cast<std::uint8_t>(i * 37 % 251);
    return frame;
}

// Oracle: the encoder was told what should be found.
TEST(JpegFacts, AreWhatTheEncoderWasTold) {
    const auto frame = colourful(50, 31);
    for (const int quality : {1, 10, 40, 49, 50, 51, 75, 90, 95, 99}) {
        for (const auto subsampling : {Subsampling::S444, Subsampling::S422, Subsampling::S420}) {
            const auto jpeg = encodeJpeg(frame, quality, subsampling);
            ASSERT_TRUE(jpeg);
            const auto facts = jpegFacts(*jpeg);
            ASSERT_TRUE(facts) << facts.error().message;
            EXPECT_EQ(facts->quality, quality);
            EXPECT_EQ(facts->width, 50);
            EXPECT_EQ(facts->height, 31);
            EXPECT_EQ(facts->subsampling, name(subsampling));
        }
    }
}

TEST(JpegFacts, WhatIsNoPictureIsAnErrorWhereverItEnds) {
    const auto jpeg = encodeJpeg(colourful(16, 16), 80, Subsampling::S420);
    ASSERT_TRUE(jpeg);
    const std::vector<std::uint8_t> nothing, text{'h', 'e', 'l', 'l', 'o'};
    EXPECT_FALSE(jpegFacts(nothing));
    EXPECT_FALSE(jpegFacts(text));
    bool whole = false;
    for (std::size_t length = 0; length < jpeg->size(); ++length) {
        const std::vector<std::uint8_t> part(jpeg->begin(),
                                             jpeg->begin() + static_cast<std::ptrdiff_t>(length));
        const bool found = jpegFacts(part).has_value();
        EXPECT_TRUE(found || !whole) << length;
        whole = found;
    }
    EXPECT_TRUE(whole);
}

}  // namespace
}  // namespace scancast::client
