// A session's video: when it begins anew, when a frame goes by itself, and how many sessions may have one.
#include "server/scheduler/video_stream.hpp"

#include <gtest/gtest.h>

#include "server/scheduler/video_places.hpp"
#include "tests/support/needs_video.hpp"
#include "tests/unit/video/moving_picture.hpp"

namespace scancast::test {
namespace {

Frame frame(int width, int height, int shift) {
    Frame frame;
    frame.width = width;
    frame.height = height;
    const auto rgba = waves(width, height, shift);
    frame.rgba.own().assign(rgba.begin(), rgba.end());
    return frame;
}

class VideoStreamTest : public ::testing::Test {
  protected:
    void SetUp() override { SCANCAST_NEEDS_VIDEO(); }
};

TEST_F(VideoStreamTest, KeysComeFirstWhereTheyAreWantedAndWithAnotherSize) {
    VideoStream video{TransientMemory()};
    std::vector<std::pair<std::uint64_t, bool>> seen;
    const auto encode = [&](int width, int height) {
        const auto coded = video.encode(frame(width, height, int(seen.size())), 80);
        ASSERT_TRUE(coded);
        seen.emplace_back(coded->number, coded->key);
    };
    encode(64, 48);
    encode(64, 48);
    video.wantKey();
    video.wantKey();
    encode(64, 48);
    encode(64, 48);
    encode(72, 48);
    encode(72, 48);
    EXPECT_EQ(seen, (std::vector<std::pair<std::uint64_t, bool>>{
                        {1, true}, {2, false}, {3, true}, {4, false}, {5, true}, {6, false}}));
}

TEST_F(VideoStreamTest, WhatCannotBeVideoGoesByItself) {
    VideoStream video{TransientMemory()};
    EXPECT_FALSE(video.encode(frame(8, 8, 0), 80));
    EXPECT_FALSE(video.hasFailed());
    EXPECT_TRUE(video.encode(frame(32, 32, 0), 80));
}

TEST_F(VideoStreamTest, EncodersStayWithinTheirPartOfMemory) {
    const std::uint64_t one = VideoEncoder::bytesFor(64, 48);
    const TransientMemory memory(8 * (2 * one + one / 2));  // an eighth of it is for encoders
    auto first = std::make_unique<VideoStream>(memory), second = std::make_unique<VideoStream>(memory);
    VideoStream third(memory);
    EXPECT_TRUE(first->encode(frame(64, 48, 0), 80));
    EXPECT_TRUE(second->encode(frame(64, 48, 0), 80));
    EXPECT_EQ(memory.bytes(MemoryUse::Video), 2 * one);
    EXPECT_FALSE(third.encode(frame(64, 48, 0), 80));
    EXPECT_FALSE(third.hasFailed()) << "there may be room later";
    second.reset();
    EXPECT_TRUE(third.encode(frame(64, 48, 0), 80));
    EXPECT_EQ(memory.bytes(MemoryUse::Video), 2 * one);
}

TEST_F(VideoStreamTest, PlacesAreGivenBack) {
    const VideoPlaces places(2);
    EXPECT_EQ(places.codecs(), (std::vector{Codec::H264, Codec::Jpeg}));
    auto first = places.take(), second = places.take();
    ASSERT_TRUE(first && second);
    const auto third = places.take();
    ASSERT_FALSE(third);
    EXPECT_EQ(third.error().code, ErrorCode::ResourceLimit);
    EXPECT_EQ(third.error().message, "All 2 of this server's places for video are taken.");
    first->reset();
    EXPECT_EQ(places.taken(), 1U);
    EXPECT_TRUE(places.take());
}

TEST(VideoPlaces, NoneWhereVideoIsOff) {
    const VideoPlaces places(0);
    EXPECT_EQ(places.codecs(), std::vector{Codec::Jpeg});
    ASSERT_FALSE(places.take());
    EXPECT_EQ(places.take().error().message, "This server is set up without video (--video-sessions 0).");
}

TEST(Quantiser, FollowsTheQualityOfJpeg) {
    for (int quality = 2; quality <= 100; ++quality)
        EXPECT_LE(quantiserFor(quality), quantiserFor(quality - 1));
    EXPECT_LT(quantiserFor(90), quantiserFor(40));
    EXPECT_GE(quantiserFor(100), 1);
    EXPECT_LE(quantiserFor(1), 51);
}

}  // namespace
}  // namespace scancast::test
