#include "client/cpp/decode.hpp"

#include <gtest/gtest.h>

#include "client/cpp/stream.hpp"
#include "tests/support/needs_video.hpp"
#include "tests/unit/video/moving_picture.hpp"
#include "video/video_encoder.hpp"

namespace scancast::client {
namespace {

using scancast::test::psnr;
using scancast::test::waves;

class FrameDecoderTest : public ::testing::Test {
  protected:
    void SetUp() override {
        SCANCAST_NEEDS_VIDEO();
        auto opened = VideoEncoder::open(width, height);
        ASSERT_TRUE(opened) << opened.error().message;
        encoder_ = std::move(*opened);
    }
    ReceivedFrame next(int shift, bool key = false) {
        auto picture = encoder_->encode(waves(width, height, shift), 20, key);
        EXPECT_TRUE(picture);
        ReceivedFrame frame;
        frame.header.codec = Codec::H264;
        frame.header.moving = true;
        frame.header.key = picture->key;
        frame.header.width = width;
        frame.header.height = height;
        frame.h264 = std::move(picture->bytes);
        return frame;
    }
    static double near(const Expected<Pixels>& pixels, int shift) {
        EXPECT_TRUE(pixels) << pixels.error().message;
        return pixels ? psnr(waves(width, height, shift), pixels->rgb) : 0;
    }

    static constexpr int width = 161, height = 90;
    std::unique_ptr<VideoEncoder> encoder_;
};

TEST_F(FrameDecoderTest, FramesComeOutInTurn) {
    FrameDecoder decoder;
    for (int i = 0; i < 4; ++i) EXPECT_GT(near(decoder.decode(next(2 * i)), 2 * i), 35);
    EXPECT_EQ(readableCodecs(), (std::vector{Codec::H264, Codec::Jpeg}));
}

TEST_F(FrameDecoderTest, AfterALossNothingIsShownBeforeTheNextKey) {
    FrameDecoder decoder;
    EXPECT_GT(near(decoder.decode(next(0)), 0), 35);
    auto broken = next(2);
    broken.h264.resize(broken.h264.size() / 2);
    EXPECT_FALSE(decoder.decode(broken));
    const auto after = decoder.decode(next(4));
    ASSERT_FALSE(after);
    EXPECT_EQ(after.error().code, ErrorCode::Truncated);
    EXPECT_GT(near(decoder.decode(next(6, true)), 6), 35);
    EXPECT_GT(near(decoder.decode(next(8)), 8), 35);
}

TEST_F(FrameDecoderTest, AFrameByItselfBetweenThemBreaksNothing) {
    FrameDecoder decoder;
    EXPECT_GT(near(decoder.decode(next(0)), 0), 35);
    ReceivedFrame jpeg;
    jpeg.jpeg = {1, 2, 3};
    EXPECT_FALSE(decoder.decode(jpeg));
    EXPECT_GT(near(decoder.decode(next(2)), 2), 35);
}

TEST_F(FrameDecoderTest, NothingLargerThanAcceptedIsDecoded) {
    FrameDecoder decoder;
    const auto large = decoder.decode(next(0), 161 * 90 - 1);
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().code, ErrorCode::ResourceLimit);
}

}  // namespace
}  // namespace scancast::client
