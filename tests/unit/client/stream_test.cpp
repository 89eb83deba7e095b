#include "client/cpp/stream.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "protocol/depth/frame_depth.hpp"
#include "protocol/view/view_json.hpp"
#include "tests/unit/client/fake_session.hpp"

namespace scancast::client {
namespace {

using namespace std::chrono_literals;
using test::FakePeer;
using test::FakeServer;

FakeServer::Script scriptOf(std::function<void(FakePeer&)> session) {
    FakeServer::Script script;
    script.session = std::move(session);
    return script;
}

/// A session that welcomes and then sends this instead of a frame.
FakeServer::Script sending(test::Bytes bytes) {
    return scriptOf([bytes](FakePeer& peer) {
        std::string text;
        if (test::welcome(peer) && peer.sendBinary(bytes)) peer.readText(text);
    });
}

const Timeouts patient{2s, 5s};

TEST(Stream, ViewsGoOutAndFramesComeBack) {
    const FakeServer fake(scriptOf(test::fakeSession));
    auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_EQ(stream->welcome().cloud, "town");
    const auto request = fake.requests().front();
    EXPECT_TRUE(request.starts_with("GET /api/v1/stream HTTP/1.1\r\n")) << request;
    EXPECT_NE(request.find("Sec-WebSocket-Protocol: scancast.v1\r\n"), std::string::npos) << request;

    for (std::uint64_t seq = 1; seq <= 3; ++seq) {
        View view;
        view.width = static_cast<int>(100 * seq);
        ASSERT_TRUE(stream->sendView(seq, view));
        for (const bool final : {false, true}) {
            const auto frame = stream->receiveFrame();
            ASSERT_TRUE(frame) << frame.error().message;
            EXPECT_EQ(frame->header.seq, seq);
            EXPECT_EQ(frame->header.final, final);
            EXPECT_EQ(frame->header.width, 100 * seq);
            ASSERT_TRUE(stream->ack(frame->header));
            if (final) {
                EXPECT_EQ(std::string(frame->jpeg.begin(), frame->jpeg.end()), printJson(toJson(view)));
            }
        }
    }
    EXPECT_TRUE(stream->close());
}

TEST(Stream, DepthIsAskedForAndUnpacked) {
    const auto packed = packDepth({2, 1, {3, 6}});
    ASSERT_TRUE(packed) << packed.error().message;
    messages::Hello said;
    const FakeServer fake(scriptOf([&](FakePeer& peer) {
        FrameHeader header;
        header.frameId = header.width = header.height = 1;
        std::string text;
        if (test::welcome(peer, "s1", {}, &said) &&
            peer.sendBinary(test::frameBytes(header, "jpeg", *packed)))
            peer.readText(text);
    }));
    messages::Hello hello;
    hello.depth = true;
    auto stream = Stream::open(fake.url(), hello, patient);
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_TRUE(said.depth);
    const auto frame = stream->receiveFrame();
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(std::string(frame->jpeg.begin(), frame->jpeg.end()), "jpeg");
    const auto depth = unpackDepth(frame->packedDepth);
    ASSERT_TRUE(depth) << depth.error().message;
    EXPECT_EQ(depth->inverse, (std::vector<float>{1.0F / 3, 1.0F / 6}));
}

TEST(Stream, ARefusedViewIsAnErrorAndTheSessionGoesOn) {
    const FakeServer fake(scriptOf(test::fakeSession));
    auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
    ASSERT_TRUE(stream) << stream.error().message;
    ASSERT_TRUE(stream->send(messages::ViewChange{1, std::nullopt, {{"widht", 5}}}));
    const auto frame = stream->receiveFrame();
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(frame.error().message, "widht: unknown; did you mean width?");
    ASSERT_TRUE(stream->sendView(2, View{}));
    EXPECT_TRUE(stream->receiveFrame());
}

TEST(Stream, WaitingALittleLosesNothing) {
    const FakeServer fake(scriptOf(test::fakeSession));
    auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
    ASSERT_TRUE(stream) << stream.error().message;
    const auto nothing = stream->receiveFor(1ms);
    ASSERT_TRUE(nothing) << nothing.error().message;
    EXPECT_FALSE(*nothing) << "nobody asked for anything yet";
    int frames = 0;
    for (std::uint64_t seq = 1; seq <= 20; ++seq) {
        // A read waits while this is sent.
        ASSERT_TRUE(stream->sendView(seq, View{}));
        const auto event = stream->receiveFor(0ms);
        ASSERT_TRUE(event) << event.error().message;
        if (*event && std::holds_alternative<ReceivedFrame>(**event)) ++frames;
    }
    while (frames < 40) {
        const auto event = stream->receiveFor(5s);
        ASSERT_TRUE(event && *event) << frames << " frames came";
        if (std::holds_alternative<ReceivedFrame>(**event)) ++frames;
    }
    EXPECT_TRUE(stream->close());
}

TEST(Stream, AnInterruptEndsTheWait) {
    const FakeServer fake(scriptOf(test::fakeSession));
    auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
    ASSERT_TRUE(stream) << stream.error().message;
    stream->interrupt();
    const auto early = stream->receiveFor(1h);
    ASSERT_TRUE(early) << early.error().message;
    EXPECT_FALSE(*early);
    std::jthread other([&] { stream->interrupt(); });
    const auto woken = stream->receiveFor(1h);
    ASSERT_TRUE(woken) << woken.error().message;
    EXPECT_FALSE(*woken);
    other.join();
    ASSERT_TRUE(stream->sendView(1, View{}));
    EXPECT_TRUE(stream->receiveFrame()) << "the session goes on";
}

TEST(Stream, ASlowLineBringsTheSameFrames) {
    const FakeServer fake(scriptOf(test::fakeSession));
    auto stream = Stream::open(fake.url(), messages::Hello{}, patient, {}, 20e3);
    ASSERT_TRUE(stream) << stream.error().message;
    ASSERT_TRUE(stream->sendView(1, View{}));
    for (const bool final : {false, true}) {
        const auto frame = stream->receiveFrame();
        ASSERT_TRUE(frame) << frame.error().message;
        EXPECT_EQ(frame->header.final, final);
    }
}

TEST(Stream, NobodyListens) {
    const auto stream = Stream::open(test::nobodysUrl(), messages::Hello{}, patient);
    ASSERT_FALSE(stream);
    EXPECT_TRUE(stream.error().message.starts_with("nothing listens at 127.0.0.1:"))
        << stream.error().message;
}

TEST(Stream, AServerThatNeverAnswersIsGivenUp) {
    FakeServer::Script silent;
    silent.silent = true;
    const FakeServer mute(silent);
    EXPECT_EQ(Stream::open(mute.url(), messages::Hello{}, {2s, 100ms}).error().code,
              ErrorCode::DeadlineExceeded);

    const FakeServer noWelcome(scriptOf([](FakePeer& peer) {
        for (std::string text; peer.readText(text);) {
        }
    }));
    EXPECT_EQ(Stream::open(noWelcome.url(), messages::Hello{}, {2s, 100ms}).error().code,
              ErrorCode::DeadlineExceeded);

    const FakeServer noFrames(scriptOf([](FakePeer& peer) {
        test::welcome(peer);
        for (std::string text; peer.readText(text);) {
        }
    }));
    auto stream = Stream::open(noFrames.url(), messages::Hello{}, {2s, 300ms});
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_EQ(stream->receiveFrame().error().code, ErrorCode::DeadlineExceeded);
    // The session is over, and says so instead of hanging or crashing.
    EXPECT_FALSE(stream->sendView(1, View{}));
    EXPECT_FALSE(stream->receive());
}

TEST(Stream, AnotherSubprotocolIsNotSpoken) {
    for (const auto* subprotocol : {"", "scancast.v2"}) {
        auto script = scriptOf(test::fakeSession);
        script.subprotocol = subprotocol;
        const FakeServer fake(script);
        const auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
        ASSERT_FALSE(stream) << subprotocol;
        EXPECT_EQ(stream.error().code, ErrorCode::Unsupported) << stream.error().message;
        EXPECT_NE(stream.error().message.find("scancast.v1"), std::string::npos);
    }
}

TEST(Stream, RefusedUpgradesSayWhy) {
    FakeServer::Script script;
    script.answers["/api/v1/stream"] = {403, "application/problem+json",
                                        printJson(toJson(problemOf(403, "this Host is not allowed"))), ""};
    const FakeServer fake(script);
    const auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
    ASSERT_FALSE(stream);
    EXPECT_EQ(stream.error().message, "this Host is not allowed");
    const FakeServer other({});
    EXPECT_NE(Stream::open(other.url(), messages::Hello{}, patient).error().message.find("404 Not Found"),
              std::string::npos);
}

TEST(Stream, TruncatedAndOddFrames) {
    FrameHeader header;
    header.width = header.height = 8;
    auto whole = test::frameBytes(header, "0123456789");
    auto frameOf = [](test::Bytes bytes) {
        const FakeServer fake(sending(std::move(bytes)));
        auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
        EXPECT_TRUE(stream);
        const auto frame = stream->receiveFrame();
        return frame ? Error{ErrorCode::Internal, "accepted", {}} : frame.error();
    };
    EXPECT_EQ(frameOf({}).code, ErrorCode::Truncated);
    EXPECT_EQ(frameOf({whole.begin(), whole.begin() + 20}).code, ErrorCode::Truncated);
    EXPECT_EQ(frameOf({whole.begin(), whole.end() - 1}).code, ErrorCode::Truncated);
    auto magic = whole;
    magic[0] = 'X';
    EXPECT_EQ(frameOf(magic).code, ErrorCode::Malformed);
    auto codec = whole;
    codec[8] = 9;
    EXPECT_EQ(frameOf(codec).code, ErrorCode::Unsupported);
    EXPECT_EQ(frameOf(whole).message, "accepted");
}

TEST(Stream, WrongFirstMessages) {
    const auto opened = [](const std::string& first) {
        const FakeServer fake(scriptOf([first](FakePeer& peer) {
            std::string text;
            peer.readText(text);
            peer.sendText(first);
            peer.readText(text);
        }));
        const auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
        return stream ? Error{ErrorCode::Internal, "accepted", {}} : stream.error();
    };
    EXPECT_EQ(opened("hello").code, ErrorCode::Malformed);
    EXPECT_EQ(opened(R"({"type": "pong"})").code, ErrorCode::Malformed);
    EXPECT_EQ(opened(R"({"type": "welcome"})").code, ErrorCode::Malformed);
    EXPECT_EQ(opened(printMessage(messages::ProblemReport{
                         {}, problemOf(Error{ErrorCode::NotFound, "no cloud x", ""})}))
                  .message,
              "no cloud x");
    EXPECT_EQ(opened(printMessage(messages::Bye{CloseCode::TryAgainLater, "all sessions are taken"})).code,
              ErrorCode::ResourceLimit);
}

TEST(Stream, GoodbyesAndLostConnections) {
    const auto afterWelcome = [](std::function<void(FakePeer&)> then) {
        const FakeServer fake(scriptOf([then](FakePeer& peer) {
            if (test::welcome(peer)) then(peer);
        }));
        auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
        EXPECT_TRUE(stream);
        const auto frame = stream->receiveFrame();
        return frame ? Error{ErrorCode::Internal, "accepted", {}} : frame.error();
    };
    const auto shutdown = afterWelcome([](FakePeer& peer) { peer.close(1001, "the server shuts down"); });
    EXPECT_EQ(shutdown.code, ErrorCode::Cancelled) << shutdown.message;
    EXPECT_NE(shutdown.message.find("the server shuts down"), std::string::npos);
    const auto policy = afterWelcome([](FakePeer& peer) { peer.close(1008, ""); });
    EXPECT_NE(policy.message.find("1008"), std::string::npos) << policy.message;
    const auto lost = afterWelcome([](FakePeer&) {});
    EXPECT_EQ(lost.code, ErrorCode::Io) << lost.message;
    EXPECT_NE(lost.message.find("closed the connection"), std::string::npos) << lost.message;
}

TEST(Stream, TextsHaveABoundAndBeforeTheWelcomeSoHasEverything) {
    const std::string tooLong((1u << 20u) + 1, ' ');
    const auto errorOf = [&](bool welcomed, bool binary) {
        const FakeServer fake(scriptOf([&](FakePeer& peer) {
            std::string text;
            if (welcomed && !test::welcome(peer)) return;
            if (!welcomed && !peer.readText(text)) return;
            if (binary ? peer.sendBinary({tooLong.begin(), tooLong.end()}) : peer.sendText(tooLong))
                peer.readText(text);
        }));
        auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
        if (!stream) return stream.error();
        const auto frame = stream->receiveFrame();
        return frame ? Error{ErrorCode::Internal, "accepted", {}} : frame.error();
    };
    EXPECT_EQ(errorOf(false, false).code, ErrorCode::ResourceLimit) << errorOf(false, false).message;
    EXPECT_EQ(errorOf(false, true).code, ErrorCode::ResourceLimit);
    EXPECT_EQ(errorOf(true, false).code, ErrorCode::ResourceLimit);
    EXPECT_EQ(errorOf(true, true).code, ErrorCode::Malformed) << "long enough for a picture, and none";
}

TEST(Stream, AGoodbyeIsNoCommandToATerminal) {
    const FakeServer fake(scriptOf([](FakePeer& peer) {
        if (test::welcome(peer)) peer.close(1008, "go\x1b[2J\xC2\x9B away");
    }));
    auto stream = Stream::open(fake.url(), messages::Hello{}, patient);
    ASSERT_TRUE(stream) << stream.error().message;
    const auto frame = stream->receiveFrame();
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().message, "the server closed the session: go?[2J? away (close code 1008)");
}

}  // namespace
}  // namespace scancast::client
