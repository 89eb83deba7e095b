// The WebSocket dialogue over a real socket.
#include <algorithm>
#include <thread>

#include "protocol/depth/frame_depth.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/needs_video.hpp"
#include "video/video_decoder.hpp"

namespace scancast::test {
namespace {

class StreamTest : public ServerTest {};

// The fake device paints the eye's x as red: which camera a picture shows can be read from it.
int redOf(const Bytes& jpeg) {
    const auto frame = decodeJpeg(jpeg);
    return frame ? frame->rgba[0] : -1;
}

TEST_F(StreamTest, HelloWelcomeMovingFinal) {
    options.limits.quiet =
        std::chrono::seconds(1);  // a moving frame that waits longer gives way to the still
    start();
    StreamClient client(port());
    ASSERT_EQ(client.socket.status(), 101);
    EXPECT_EQ(client.socket.reply().header("sec-websocket-protocol"), "scancast.v1");
    const auto welcome = client.greet({{"cloud", "two"}});
    EXPECT_EQ(welcome["cloud"], "two");
    EXPECT_EQ(welcome["view"]["width"], 64);
    client.view(1, 60);
    auto moving = client.frame();
    while (moving && moving->header.seq == 0)
        moving = client.frame();  // the welcome's view, if that took long
    ASSERT_TRUE(moving);
    EXPECT_TRUE(moving->header.moving);
    EXPECT_EQ(moving->header.seq, 1U);
    const auto still = client.frame();
    ASSERT_TRUE(still);
    EXPECT_TRUE(still->header.final);
    EXPECT_FALSE(still->header.moving);
    EXPECT_EQ(still->header.seq, 1U);
    EXPECT_EQ(still->header.frameId, moving->header.frameId + 1);
    EXPECT_EQ(still->header.width, 64U);
}

TEST_F(StreamTest, TheWelcomesViewIsShownUnasked) {
    start();
    StreamClient client(port());
    client.greet();
    const auto frame = client.frame();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(frame->header.final);
    EXPECT_EQ(frame->header.seq, 0U);
}

TEST_F(StreamTest, AfterFinalThereIsSilence) {
    start();
    StreamClient client(port());
    client.greet();
    client.view(1, 60);
    ASSERT_TRUE(client.finalFrame(1));
    EXPECT_FALSE(client.frame(std::chrono::milliseconds(300)));
}

// The picture's bytes tell which cloud it shows: the fake device paints the number of its points.
TEST_F(StreamTest, WhoStandsStillSeesTheWholeCloudOnceItIsLoaded) {
    start();
    Catalog& catalog = server->catalog();
    const std::string id = catalog.add("growing");
    catalog.setPreview(id, tinyCloud(10));
    StreamClient client(port());
    client.greet({{"cloud", id}});
    const auto coarse = client.finalFrame(0);
    ASSERT_TRUE(coarse);
    EXPECT_FALSE(client.frame(std::chrono::milliseconds(400))) << "nothing new yet";
    catalog.setPreview(id, tinyCloud(60));
    const auto finer = client.finalFrame(0);
    ASSERT_TRUE(finer);
    EXPECT_NE(finer->picture, coarse->picture);
    catalog.setReady(id, tinyCloud(250));
    const auto whole = client.finalFrame(0);
    ASSERT_TRUE(whole);
    EXPECT_NE(whole->picture, finer->picture);
    EXPECT_FALSE(client.frame(std::chrono::milliseconds(400))) << "and then there is silence";
}

TEST_F(StreamTest, WhoStandsStillSeesALiveCloudMove) {
    start();
    Catalog& catalog = server->catalog();
    const std::string id = catalog.addLive("depth");
    catalog.setLive(id, {}, tinyCloud(10));
    StreamClient client(port());
    client.greet({{"cloud", id}});
    const auto first = client.finalFrame(0);
    ASSERT_TRUE(first);
    for (const std::uint64_t points : {60U, 250U}) {
        catalog.setLive(id, {}, tinyCloud(points));
        server->cloudsChanged();
        const auto moving = client.frame();
        ASSERT_TRUE(moving);
        EXPECT_TRUE(moving->header.moving) << "at once";
        const auto still = client.finalFrame(0);
        ASSERT_TRUE(still);
        EXPECT_NE(still->picture, first->picture);
    }
    EXPECT_FALSE(client.frame(std::chrono::milliseconds(300))) << "and then there is silence";
}

TEST_F(StreamTest, TheFinalStillIsTheSnapshotByteForByte) {
    start();
    StreamClient client(port());
    client.greet({{"cloud", "one"}, {"width", 48}, {"height", 32}});
    client.view(9, 77);
    const auto still = client.finalFrame(9);
    ASSERT_TRUE(still);
    const HttpReply snapshot =
        request(port(), "/api/v1/clouds/one/snapshot.jpg?width=48&height=32&eye=77,-50,30&target=5,5,0");
    ASSERT_EQ(snapshot.status, 200);
    EXPECT_EQ(std::string(still->picture.begin(), still->picture.end()), snapshot.body);
}

TEST_F(StreamTest, MovingFramesAreVideoForWhoAsksAndTheFinalStillIsTheSnapshotAllTheSame) {
    SCANCAST_NEEDS_VIDEO();
    start();
    StreamClient client(port());
    const auto welcome =
        client.greet({{"cloud", "one"}, {"width", 48}, {"height", 32}, {"codecs", {"h264", "jpeg"}}});
    EXPECT_EQ(welcome["codecs"], (nlohmann::json{"h264", "jpeg"}));
    EXPECT_EQ(welcome["movingCodec"], "h264");
    const auto decoder = VideoDecoder::open();
    ASSERT_TRUE(decoder);
    std::uint64_t seq = 0;
    int videos = 0;
    for (bool isFinal = false; videos < 3 || !isFinal;) {
        if (isFinal || seq == 0) {
            ++seq;
            client.view(seq, double(60 + seq));
        }
        const auto frame = client.frame();
        ASSERT_TRUE(frame);
        isFinal = frame->header.final && frame->header.seq == seq;
        EXPECT_EQ(frame->header.codec, frame->header.moving ? Codec::H264 : Codec::Jpeg);
        if (!frame->header.moving) continue;
        ++videos;
        EXPECT_TRUE(frame->header.key) << "a still was before it";
        EXPECT_TRUE((*decoder)->decode(frame->picture, int(frame->header.width), int(frame->header.height)));
    }
    client.view(++seq, 77);
    const auto still = client.finalFrame(seq);
    ASSERT_TRUE(still);
    const HttpReply snapshot =
        request(port(), "/api/v1/clouds/one/snapshot.jpg?width=48&height=32&eye=77,-50,30&target=5,5,0");
    ASSERT_EQ(snapshot.status, 200);
    EXPECT_EQ(std::string(still->picture.begin(), still->picture.end()), snapshot.body);
}

TEST_F(StreamTest, DepthComesWithEachFrameOfWhoAsksAndThePictureIsTheSame) {
    start();
    StreamClient plain(port()), deep(port());
    plain.greet();
    deep.greet({{"depth", true}});
    for (std::uint64_t seq = 1; seq <= 3; ++seq) {
        plain.view(seq, double(seq));
        deep.view(seq, double(seq));
        while (true) {
            const auto frame = deep.frame();
            ASSERT_TRUE(frame);
            const auto depth = unpackDepth(frame->packedDepth);
            ASSERT_TRUE(depth) << depth.error().message;
            EXPECT_EQ(std::size_t(depth->width) * std::size_t(depth->height), depth->inverse.size());
            EXPECT_TRUE(std::ranges::all_of(depth->inverse, [](float inverse) { return inverse == 1; }))
                << "as the painter's pixels are";
            if (!frame->header.final || frame->header.seq != seq) continue;
            EXPECT_EQ(depth->width, 64);
            EXPECT_EQ(depth->height, 48);
            const auto same = plain.finalFrame(seq);
            ASSERT_TRUE(same);
            EXPECT_TRUE(same->packedDepth.empty());
            EXPECT_EQ(same->picture, frame->picture);
            break;
        }
    }
    EXPECT_TRUE(eventually([&] { return options.scheduler.memory.bytes(MemoryUse::Streams) == 0; }))
        << "what was sent is not counted any more";
}

TEST_F(StreamTest, TheLatestViewWins) {
    painter.closeGate();
    start();
    StreamClient client(port());
    client.greet();
    client.view(1, 1);
    ASSERT_TRUE(painter.waitBegun(1));
    for (std::uint64_t seq = 2; seq <= 60; ++seq) client.view(seq, double(seq));
    client.say({{"type", "ping"}, {"id", 5}});
    EXPECT_EQ(client.control("pong")["id"], 5);  // everything before it has arrived
    painter.openGate();
    ASSERT_TRUE(client.finalFrame(60));
    // Of sixty views the first was drawn, at most one more that was in the mailbox, the last, and the last as
    // a still.
    EXPECT_LE(painter.begun().size(), 4U);
}

TEST_F(StreamTest, AClientThatDoesNotAcknowledgeGetsTwoFramesAndThenTheFinalOne) {
    start();
    StreamClient client(port());
    client.greet();
    std::vector<FrameHeader> got;
    const auto take = [&](std::chrono::milliseconds patience) {
        const WsMessage message = client.socket.receiveKind(WsMessage::Kind::Binary, patience);
        if (message.kind != WsMessage::Kind::Binary) return false;
        got.push_back(parseFrame({reinterpret_cast<const std::uint8_t*>(message.payload.data()),
                                  message.payload.size()})
                          ->header);
        return true;
    };
    for (std::uint64_t seq = 1; seq <= 20; ++seq) client.view(seq, double(seq));
    ASSERT_TRUE(take(netPatience));
    ASSERT_TRUE(take(netPatience));
    EXPECT_FALSE(take(std::chrono::milliseconds(300)));
    client.ack(got.back());
    while (!got.back().final) ASSERT_TRUE(take(netPatience));
    EXPECT_EQ(got.back().seq, 20U);
}

TEST_F(StreamTest, TwoClientsWithTheirOwnCamerasNeverMix) {
    start();
    std::vector<std::thread> clients;
    std::atomic<int> wrong{0};
    std::atomic<int> frames{0};
    for (int c = 0; c < 2; ++c) {
        clients.emplace_back([&, c] {
            StreamClient client(port());
            client.greet({{"cloud", c == 0 ? "one" : "two"}});
            for (std::uint64_t seq = 1; seq <= 40; ++seq) {
                client.view(seq, c == 0 ? 40 : 200);
                const auto frame = client.frame();
                if (!frame) {
                    ++wrong;
                    return;
                }
                ++frames;
                if (frame->header.seq == 0) continue;
                // JPEG may be off by a little; the two cameras are 160 apart.
                if (std::abs(redOf(frame->picture) - (c == 0 ? 40 : 200)) > 12) ++wrong;
            }
        });
    }
    for (auto& thread : clients) thread.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(frames, 80);
}

TEST_F(StreamTest, ResizingAndSwitchingClouds) {
    start();
    StreamClient client(port());
    client.greet({{"cloud", "one"}});
    client.say({{"type", "view"}, {"seq", 1}, {"width", 80}, {"height", 40}});
    const auto resized = client.finalFrame(1);
    ASSERT_TRUE(resized);
    EXPECT_EQ(resized->header.width, 80U);
    client.say({{"type", "view"}, {"seq", 2}, {"cloud", "two"}});
    const auto switched = client.finalFrame(2);
    ASSERT_TRUE(switched);
    EXPECT_EQ(switched->header.width, 80U);
    EXPECT_EQ(painter.begun().back().cloud, two.get());
}

TEST_F(StreamTest, ARefusedViewIsAProblemWithItsSeqAndNothingElse) {
    start();
    StreamClient client(port());
    client.greet();
    client.say({{"type", "view"}, {"seq", 3}, {"camera", {{"fvo", 3}}}});
    const auto problem = client.control("problem");
    EXPECT_EQ(problem["seq"], 3);
    EXPECT_EQ(problem["problem"]["status"], 400);
    EXPECT_EQ(problem["problem"]["errors"][0]["parameter"], "camera.fvo");
    client.view(4, 10);
    EXPECT_TRUE(client.finalFrame(4));
}

TEST_F(StreamTest, SessionsAreLimitedAndGivenBack) {
    options.limits.maxSessions = 2;
    start();
    {
        StreamClient a(port());
        StreamClient b(port());
        EXPECT_EQ(a.greet()["type"], "welcome");
        EXPECT_EQ(b.greet()["type"], "welcome");
        StreamClient c(port());
        EXPECT_EQ(c.closeCode(), 1013);
    }
    EXPECT_TRUE(eventually([&] { return metric("scancast_sessions") == "scancast_sessions 0"; }));
    StreamClient d(port());
    EXPECT_EQ(d.greet()["type"], "welcome");
}

TEST_F(StreamTest, ShutdownTellsEverybody) {
    painter.closeGate();  // a picture is under way meanwhile
    start();
    StreamClient idle(port());
    StreamClient busy(port());
    idle.greet();
    busy.greet();
    busy.view(1, 1);
    ASSERT_TRUE(painter.waitBegun(1));
    RawSocket waiting(port());
    waiting.send("GET /api/v1/clouds/one/snapshot.jpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
    server->shutDown();
    EXPECT_EQ(idle.control("bye")["code"], 1001);
    EXPECT_EQ(idle.closeCode(), 1001);
    EXPECT_EQ(busy.closeCode(), 1001);
    // Whoever answers a close frame has left; these clients do it by hanging up.
    idle.socket.socket().abort();
    busy.socket.socket().abort();
    waiting.abort();
    EXPECT_TRUE(server->waitForClients(netPatience));
    EXPECT_FALSE(RawSocket(port()).send("GET / HTTP/1.1\r\n\r\n") && request(port(), "/healthz").status != 0);
}

TEST_F(StreamTest, DrainingEndsStreamsAndFinishesSnapshots) {
    painter.closeGate();
    start();
    RawSocket waiting(port());
    waiting.send("GET /api/v1/clouds/one/snapshot.jpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_TRUE(painter.waitBegun(1));
    StreamClient client(port());
    client.greet();
    EXPECT_EQ(request(port(), "/readyz").status, 200);
    server->drain();
    EXPECT_EQ(client.control("bye")["code"], 1001);
    EXPECT_EQ(client.closeCode(), 1001);
    client.socket.socket().abort();
    EXPECT_EQ(request(port(), "/readyz").status, 503);
    EXPECT_EQ(request(port(), "/healthz").status, 200);
    const HttpReply refused = request(port(), "/api/v1/clouds/two/snapshot.jpg");
    EXPECT_EQ(refused.status, 503);
    EXPECT_NE(refused.header("retry-after"), "");
    EXPECT_EQ(RawWebSocket(port()).status(), 503);
    painter.openGate();
    EXPECT_EQ(readReply(waiting).status, 200) << "it was promised";
    EXPECT_TRUE(eventually([&] { return server->drained(); }));
    server->shutDown();
    EXPECT_TRUE(server->waitForClients(netPatience));
}

TEST_F(StreamTest, AClientThatComesBackGoesOnWithItsSession) {
    start();
    std::string token, id;
    std::uint64_t last = 0;
    {
        StreamClient client(port());
        const auto welcome = client.greet({{"cloud", "two"}});
        token = welcome["resume"];
        id = welcome["session"];
        client.view(5, 90);
        const auto shown = client.finalFrame(5);
        ASSERT_TRUE(shown);
        last = shown->header.frameId;
        client.socket.socket().abort();
    }
    StreamClient client(port());
    const auto welcome = client.greet({{"resume", token}});
    EXPECT_EQ(welcome["resumed"], true);
    EXPECT_EQ(welcome["session"], id);
    EXPECT_EQ(welcome["cloud"], "two");
    EXPECT_EQ(welcome["seq"], 5);
    const auto again = client.finalFrame(5);
    ASSERT_TRUE(again);
    EXPECT_GT(again->header.frameId, last);
    EXPECT_NEAR(redOf(again->picture), 90, 12);
}

TEST_F(StreamTest, AClientThatComesBackBeforeItsOldLineIsFoundDeadTakesItsSessionAlong) {
    start();
    StreamClient old(port());
    const std::string token = old.greet()["resume"];
    ASSERT_TRUE(old.finalFrame(0));
    StreamClient client(port());
    EXPECT_EQ(client.greet({{"resume", token}})["resumed"], true);
    EXPECT_EQ(old.closeCode(), 1008);
    EXPECT_TRUE(client.finalFrame(0));
}

TEST_F(StreamTest, PingsComeWhileNothingElseHappens) {
    options.limits.idleTimeout = std::chrono::milliseconds(400);
    start();
    StreamClient client(port());
    client.greet();
    ASSERT_TRUE(client.frame());
    // Pings are answered in receive(); a client that answers stays connected beyond the idle time-out.
    EXPECT_FALSE(client.frame(std::chrono::milliseconds(1500)));
    client.view(1, 5);
    EXPECT_TRUE(client.finalFrame(1));
}

}  // namespace
}  // namespace scancast::test
