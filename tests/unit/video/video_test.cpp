// The encoder against the standard - its headers are read by a reader of our own - and against the decoder: what comes back is
// near to what went in.
#include <gtest/gtest.h>

#include "tests/support/needs_video.hpp"
#include "tests/unit/video/bit_reader.hpp"
#include "tests/unit/video/moving_picture.hpp"
#include "video/video_decoder.hpp"
#include "video/video_encoder.hpp"

namespace scancast::test {
namespace {

constexpr int nonIdrSlice = 1, idrSlice = 5, sequenceParameters = 7, pictureParameters = 8;
constexpr int baseline = 66;

class Video : public ::testing::Test {
  protected:
    void SetUp() override { SCANCAST_NEEDS_VIDEO(); }
    static std::unique_ptr<VideoEncoder> encoder(int width, int height) {
        auto opened = VideoEncoder::open(width, height);
        EXPECT_TRUE(opened) << opened.error().message;
        return std::move(*opened);
    }
    static std::unique_ptr<VideoDecoder> decoder() {
        auto opened = VideoDecoder::open();
        EXPECT_TRUE(opened) << opened.error().message;
        return std::move(*opened);
    }
    static VideoPicture coded(VideoEncoder& encoder, int shift, int quantiser = 20, bool key = false) {
        auto picture = encoder.encode(waves(encoder.width(), encoder.height(), shift), quantiser, key);
        EXPECT_TRUE(picture) << picture.error().message;
        return std::move(*picture);
    }
    static std::vector<int> types(const VideoPicture& picture) {
        std::vector<int> found;
        for (const auto& unit : nalUnits(picture.bytes)) found.push_back(unit.front() & 31);
        return found;
    }
};

TEST_F(Video, PicturesComeBackAsTheyWere) {
    for (const auto& [width, height] : {std::pair{320, 180}, {321, 181}, {320, 181}, {16, 16}, {17, 33}}) {
        const auto from = encoder(width, height);
        const auto to = decoder();
        for (int i = 0; i < 4; ++i) {
            const auto picture = coded(*from, 3 * i);
            EXPECT_EQ(picture.key, i == 0);
            const auto rgb = to->decode(picture.bytes, width, height);
            ASSERT_TRUE(rgb) << rgb.error().message;
            ASSERT_EQ(rgb->size(), std::size_t(width) * std::size_t(height) * 3);
            EXPECT_GT(psnr(waves(width, height, 3 * i), *rgb), 35)
                << width << " x " << height << ", frame " << i;
        }
    }
}

TEST_F(Video, TheStreamSaysThatNothingIsReorderedAndWhatItsColoursAre) {
    for (const auto& [width, height] : {std::pair{1280, 720}, {641, 361}, {48, 80}}) {
        const auto units = nalUnits(coded(*encoder(width, height), 0).bytes);
        ASSERT_EQ(units.size(), 3U);
        const Sps sps = readSps(units[0]);
        EXPECT_EQ(sps.profile, unsigned(baseline));
        EXPECT_TRUE(sps.constraints & 0x40) << "constrained baseline";
        EXPECT_EQ(sps.width, (width + 1) / 2 * 2);
        EXPECT_EQ(sps.height, (height + 1) / 2 * 2);
        EXPECT_EQ(sps.referenceFrames, 1U);
        ASSERT_TRUE(sps.hasRestriction) << "else decoders wait for pictures that may come earlier";
        EXPECT_EQ(sps.mostReordered, 0U);
        EXPECT_LE(sps.mostHeldBack, 1U);
        EXPECT_TRUE(sps.hasColors && sps.fullRange);
        EXPECT_EQ(sps.primaries, 1U) << "sRGB's";
        EXPECT_EQ(sps.transfer, 13U) << "sRGB's";
        EXPECT_EQ(sps.matrix, 6U) << "BT.601, as JPEG has it";
    }
}

TEST_F(Video, APictureIsOneSliceAndKeysComeWhenTheyAreAskedFor) {
    const auto from = encoder(320, 180);
    for (int i = 0; i < 70; ++i) {
        const bool asked = i == 30;
        // Another quantiser begins nothing anew.
        const auto picture = coded(*from, i, 20 + i % 20, asked);
        EXPECT_EQ(picture.key, i == 0 || asked) << i;
        const std::vector<int> expected = picture.key
                                              ? std::vector{sequenceParameters, pictureParameters, idrSlice}
                                              : std::vector{nonIdrSlice};
        EXPECT_EQ(types(picture), expected) << i;
    }
}

TEST_F(Video, ACoarserQuantiserTakesFewerBytesAndIsFurtherAway) {
    std::size_t bytes = 1 << 30;
    double near = 100;
    for (const int quantiser : {16, 26, 36}) {
        const auto picture = coded(*encoder(320, 180), 0, quantiser);
        const auto rgb = decoder()->decode(picture.bytes, 320, 180);
        ASSERT_TRUE(rgb);
        const double is = psnr(waves(320, 180, 0), *rgb);
        EXPECT_LT(picture.bytes.size(), bytes);
        EXPECT_LT(is, near);
        bytes = picture.bytes.size();
        near = is;
    }
}

TEST_F(Video, WhatCutsTheChainIsToldAndAKeyMendsIt) {
    const auto from = encoder(320, 180);
    const auto first = coded(*from, 0), lost = coded(*from, 3), after = coded(*from, 6);
    const auto mended = coded(*from, 9, 20, true);
    const auto to = decoder();
    ASSERT_TRUE(to->decode(first.bytes, 320, 180));
    std::vector<std::uint8_t> half(lost.bytes.begin(),
                                   lost.bytes.begin() + std::ptrdiff_t(lost.bytes.size() / 2));
    EXPECT_FALSE(to->decode(half, 320, 180));
    EXPECT_FALSE(to->decode({}, 320, 180));
    const auto again = decoder();
    EXPECT_FALSE(again->decode(after.bytes, 320, 180)) << "it has none before it";
    const auto rgb = again->decode(mended.bytes, 320, 180);
    ASSERT_TRUE(rgb) << rgb.error().message;
    EXPECT_GT(psnr(waves(320, 180, 9), *rgb), 35);
}

TEST_F(Video, APictureOfAnotherSizeThanTheFrameSaysIsRefused) {
    const auto picture = coded(*encoder(320, 180), 0);
    for (const auto& [width, height] :
         {std::pair{322, 180}, {320, 178}, {318, 180}, {0, 180}, {16384, 16384}}) {
        const auto rgb = decoder()->decode(picture.bytes, width, height);
        ASSERT_FALSE(rgb);
        EXPECT_EQ(rgb.error().code, ErrorCode::Malformed);
    }
    EXPECT_TRUE(decoder()->decode(picture.bytes, 319, 179)) << "which is how an odd one comes";
}

TEST_F(Video, SizesThatThereAreNone) {
    for (const auto& [width, height] :
         {std::pair{15, 200}, {200, 1}, {4097, 16}, {4096, 2305}, {16384, 16}}) {
        EXPECT_FALSE(VideoEncoder::takes(width, height)) << width << " x " << height;
        EXPECT_FALSE(VideoEncoder::open(width, height));
    }
    EXPECT_TRUE(VideoEncoder::takes(4096, 2304));
    EXPECT_TRUE(VideoEncoder::takes(4095, 2303));
    EXPECT_TRUE(VideoEncoder::takes(16, 16));
    EXPECT_TRUE(VideoEncoder::takes(2160, 3840)) << "a telephone's";
}

}  // namespace
}  // namespace scancast::test
