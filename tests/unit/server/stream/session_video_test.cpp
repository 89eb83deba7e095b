// Which codec a session's frames have, and when its video begins anew.
#include "tests/support/needs_video.hpp"
#include "tests/unit/server/stream/session_fixture.hpp"

namespace scancast::test {
namespace {

class SessionVideo : public SessionTest {
  protected:
    SessionVideo() { begin(places); }
    void begin(const VideoPlaces& from) {
        SessionOptions options;
        options.id = "s1";
        options.maxPixels = 4'000'000;
        options.video = &from;
        session.emplace(options, world, port, metrics, now);
    }
    void SetUp() override { SCANCAST_NEEDS_VIDEO(); }
    void helloWith(const json& codecs) {
        say({{"type", "hello"}, {"width", 640}, {"height", 480}, {"codecs", codecs}});
    }
    const json& welcome() const { return port.texts.at(0); }
    /// The session's video takes the n-th order.
    void finishVideo(std::size_t n, std::uint64_t number, bool key = false) {
        EncodedPicture picture;
        picture.bytes = std::make_shared<const Bytes>(Bytes{0, 0, 1});
        picture.codec = Codec::H264;
        picture.videoNumber = number;
        picture.key = key;
        picture.width = order(n).view.width;
        picture.height = order(n).view.height;
        session->pictureDone(port.orders.at(n).number, std::move(picture), now);
    }
    /// Whether the video's next picture will be a key: the encoder says so, of a picture that nobody gets.
    bool keyIsDue(const std::shared_ptr<VideoStream>& video) {
        Frame frame;
        frame.width = frame.height = 16;
        frame.rgba.own().assign(16 * 16 * 4, 128);
        return video->encode(frame, 80)->key;
    }
    /// The first still is out of the way, and the video's first key too.
    std::shared_ptr<VideoStream> moving() {
        helloWith({"h264", "jpeg"});
        pass(150);
        finish(0);
        ack(1);
        view(1, 0);
        auto video = order(1).video;
        EXPECT_TRUE(keyIsDue(video));
        finishVideo(1, 1, true);
        ack(2);
        EXPECT_FALSE(keyIsDue(video)) << "which was number 2";
        return video;
    }

    const VideoPlaces places{1};
};

TEST_F(SessionVideo, WhoSaysNothingGetsJpegAlone) {
    hello();
    EXPECT_EQ(welcome()["codecs"], (json{"h264", "jpeg"}));
    EXPECT_EQ(welcome()["movingCodec"], "jpeg");
    EXPECT_EQ(welcome()["codecReason"], "");
    view(1, 0);
    pass(150);
    for (const auto& placed : port.orders) EXPECT_FALSE(placed.order.video);
    EXPECT_EQ(places.taken(), 0U);
}

TEST_F(SessionVideo, SoDoesWhoRathersJpeg) {
    helloWith({"jpeg", "h264"});
    EXPECT_EQ(welcome()["movingCodec"], "jpeg");
    EXPECT_EQ(places.taken(), 0U);
}

TEST_F(SessionVideo, MovingFramesAreVideoAndStillsAreNot) {
    helloWith({"h264", "jpeg"});
    EXPECT_EQ(welcome()["movingCodec"], "h264");
    EXPECT_EQ(welcome()["codecReason"], "");
    pass(150);
    ASSERT_EQ(port.orders.size(), 1U);
    EXPECT_FALSE(order(0).video) << "a still";
    finish(0);
    ack(1);
    view(1, 0);
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_TRUE(order(1).video);
    EXPECT_EQ(order(1).view.quality.subsampling, Subsampling::S420);
    finishVideo(1, 1, true);
    ack(2);
    view(2, 1);
    finishVideo(2, 2);
    ack(3);
    pass(150);
    ASSERT_EQ(port.orders.size(), 4U);
    EXPECT_FALSE(order(3).video) << "the final still";
    finish(3);
    ASSERT_EQ(port.frames.size(), 4U);
    EXPECT_EQ(port.frames[1].codec, Codec::H264);
    EXPECT_TRUE(port.frames[1].key && port.frames[1].moving);
    EXPECT_EQ(port.frames[2].codec, Codec::H264);
    EXPECT_FALSE(port.frames[2].key);
    EXPECT_EQ(port.frames[3].codec, Codec::Jpeg);
    EXPECT_TRUE(port.frames[3].final && !port.frames[3].key);
}

TEST_F(SessionVideo, AStillIsFollowedByAKey) {
    const auto video = moving();
    pass(150);
    finish(port.orders.size() - 1);
    ASSERT_TRUE(port.frames.back().final);
    EXPECT_TRUE(keyIsDue(video));
}

TEST_F(SessionVideo, AFrameThatBuildsOnOneThatWasNotSentIsNotSentEither) {
    const auto video = moving();
    const auto before = port.frames.size();
    view(2, 1);
    const auto n = port.orders.size() - 1;
    finishVideo(n, 3);  // number 2 was encoded and went nowhere
    EXPECT_EQ(port.frames.size(), before);
    EXPECT_TRUE(keyIsDue(video));
    pass(40);  // a view that has waited is drawn when the next one should have come
    ASSERT_EQ(port.orders.size(), n + 2) << "the view is shown all the same";
    finishVideo(n + 1, 5, true);
    ASSERT_EQ(port.frames.size(), before + 1);
    EXPECT_TRUE(port.frames.back().key);
    ack(port.frames.back().frameId);
    view(3, 2);
    finishVideo(port.orders.size() - 1, 6);
    EXPECT_EQ(port.frames.size(), before + 2);
}

TEST_F(SessionVideo, AFrameThatWentByItselfBreaksNothing) {
    moving();
    view(2, 1);
    finish(port.orders.size() - 1);  // JPEG: its encoder had no memory
    EXPECT_EQ(port.frames.back().codec, Codec::Jpeg);
    EXPECT_TRUE(port.frames.back().moving);
}

TEST_F(SessionVideo, OneThatComesAfterTheFinalStillDoesNotCoverIt) {
    const auto video = moving();
    view(2, 1);
    const auto n = port.orders.size() - 1;
    ASSERT_TRUE(order(n).video);
    pass(150);
    const auto still = port.orders.size() - 1;
    ASSERT_GT(still, n) << "a still is ordered beside it";
    finish(still);
    ASSERT_TRUE(port.frames.back().final);
    const auto sent = port.frames.size();
    finishVideo(n, 3);
    EXPECT_EQ(port.frames.size(), sent);
    EXPECT_TRUE(keyIsDue(video));
}

// As where pictures are too large for it, or encoders may have no memory: what JPEGs take is what counts then.
TEST_F(SessionVideo, WhoseFramesAreJpegAllTheSameFollowsTheLineToo) {
    moving();
    int quality = 100;
    for (std::uint64_t i = 2; i < 12; ++i) {
        view(i, double(i));
        const auto n = port.orders.size() - 1;
        EXPECT_TRUE(order(n).video) << "the next one might be one";
        quality = order(n).view.quality.jpegQuality;
        EncodedPicture picture;
        picture.bytes = std::make_shared<const Bytes>(Bytes(100'000));
        picture.width = order(n).view.width;
        picture.height = order(n).view.height;
        session->pictureDone(port.orders.at(n).number, std::move(picture), now);
        now += milliseconds(100);
        ack(port.frames.back().frameId);
    }
    EXPECT_LT(quality, 60) << "of the default, 1 MB a second at 30 frames";
}

TEST_F(SessionVideo, WhoComesWhenAllPlacesAreTakenGetsJpegAndIsTold) {
    auto taken = places.take();
    ASSERT_TRUE(taken);
    helloWith({"h264", "jpeg"});
    EXPECT_EQ(welcome()["movingCodec"], "jpeg");
    EXPECT_EQ(welcome()["codecReason"], "All 1 of this server's places for video are taken.");
    view(1, 0);
    EXPECT_FALSE(order(0).video);
}

TEST_F(SessionVideo, WhoLeavesGivesHisPlaceBack) {
    helloWith({"h264", "jpeg"});
    EXPECT_EQ(places.taken(), 1U);
    session->connectionLost(true, now);
    EXPECT_EQ(places.taken(), 0U);
    begin(places);
    helloWith({"h264", "jpeg"});
    EXPECT_EQ(places.taken(), 1U);
    session->goAway();
    EXPECT_EQ(places.taken(), 0U);
}

TEST_F(SessionVideo, WithoutVideoNobodyHasIt) {
    const VideoPlaces none(0);
    begin(none);
    helloWith({"h264", "jpeg"});
    EXPECT_EQ(welcome()["codecs"], json{"jpeg"});
    EXPECT_EQ(welcome()["movingCodec"], "jpeg");
    EXPECT_EQ(welcome()["codecReason"], "This server is set up without video (--video-sessions 0).");
}

TEST_F(SessionVideo, WrongCodecsAreRefusedByName) {
    const auto refused = [&](const json& codecs) {
        begin(places);
        port.texts.clear();
        helloWith(codecs);
        return port.texts.at(0)["problem"]["detail"].get<std::string>();
    };
    EXPECT_EQ(refused({"h265", "jpeg"}), "codecs[0]: unknown; did you mean h264?");
    EXPECT_EQ(refused({"h264"}), "codecs: must hold \"jpeg\": stills are JPEG for everybody");
    EXPECT_EQ(refused({"jpeg", "jpeg"}), "codecs[1]: is named twice");
    EXPECT_EQ(refused({"jpeg", 7}), "codecs[1]: expected the name of a codec");
    EXPECT_EQ(refused("h264"), "codecs: expected an array of one or two names");
    EXPECT_EQ(refused(json::array()), "codecs: expected an array of one or two names");
    EXPECT_EQ(refused({"jpeg", "h264", "jpeg"}), "codecs: expected an array of one or two names");
}

}  // namespace
}  // namespace scancast::test
