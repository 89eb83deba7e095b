#include "protocol/messages.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "protocol/view/view_json.hpp"

namespace scancast {
namespace {

using namespace messages;

Error refused(const std::string& text) {
    const auto message = parseClientMessage(text);
    if (!message) return message.error();
    ADD_FAILURE() << "accepted " << text;
    return {};
}

TEST(ClientMessages, RoundTrip) {
    Hello hello;
    hello.cloud = "town";
    hello.width = 800;
    hello.height = 600;
    hello.pixelRatio = 1.5;
    hello.fps = 60;
    hello.resume = "token";
    hello.depth = true;
    hello.view = {{"width", 5}, {"camera", {{"fov", 50}}}};
    hello.seq = 18446744073709551615u;
    hello.frame = 77;
    hello.codecs = {Codec::H264, Codec::Jpeg};
    Hello follower;
    follower.follow = "s1";
    ViewChange view{18446744073709551615u, "other", {{"width", 5}, {"camera", {{"fov", 50}}}}};
    const std::vector<ClientMessage> all{Hello{},
                                         hello,
                                         ViewChange{},
                                         view,
                                         QualityLimits{},
                                         QualityLimits{15, 0.25, 4, 20},
                                         Pick{3, 10.5, 20},
                                         Ack{7},
                                         Ping{8},
                                         follower,
                                         ViewChange{4, {}, {{"width", 9}}, "s1"},
                                         ViewChange{5, {}, nlohmann::json::object(), ""}};
    for (const auto& message : all) {
        const auto text = printMessage(message);
        const auto back = parseClientMessage(text);
        ASSERT_TRUE(back) << text << ": " << back.error().message;
        EXPECT_EQ(*back, message) << text;
    }
}

TEST(ClientMessages, CodecsAreReadAndWrongOnesNamed) {
    EXPECT_EQ(printMessage(ClientMessage(Hello{})).find("codecs"), std::string::npos)
        << "as older servers know it";
    const auto hello = parseClientMessage(R"({"type": "hello", "codecs": ["h264", "jpeg"]})");
    ASSERT_TRUE(hello) << hello.error().message;
    EXPECT_EQ(std::get<Hello>(*hello).codecs, (std::vector{Codec::H264, Codec::Jpeg}));
    EXPECT_EQ(refused(R"({"type": "hello", "codecs": ["jpeg", "hevc"]})").field, "codecs[1]");
    EXPECT_EQ(refused(R"({"type": "hello", "codecs": ["h264"]})").field, "codecs");
    EXPECT_EQ(refused(R"({"type": "hello", "codecs": "jpeg"})").field, "codecs");
}

TEST(ClientMessages, AHelloWithoutDepthIsAsOlderServersKnowIt) {
    EXPECT_EQ(printMessage(ClientMessage(Hello{})).find("depth"), std::string::npos);
    EXPECT_EQ(refused(R"({"type": "hello", "depth": 1})").field, "depth");
}

TEST(ClientMessages, AViewCarriesOnlyWhatIsOfTheView) {
    const auto message =
        parseClientMessage(R"({"type": "view", "seq": 3, "cloud": "b", "width": 640, "color": "lod"})");
    ASSERT_TRUE(message) << message.error().message;
    const auto& view = std::get<ViewChange>(*message);
    EXPECT_EQ(view.seq, 3u);
    EXPECT_EQ(view.cloud, "b");
    const auto applied = applyJson(View{}, view.changes);
    ASSERT_TRUE(applied) << applied.error().message;
    EXPECT_EQ(applied->width, 640);
    EXPECT_EQ(applied->style.color, ColorSource::Lod);
}

TEST(ClientMessages, ATypoInAViewIsFoundWhenItIsApplied) {
    const auto message = parseClientMessage(R"({"type": "view", "seq": 3, "widht": 640})");
    ASSERT_TRUE(message);
    const auto applied = applyJson(View{}, std::get<ViewChange>(*message).changes);
    ASSERT_FALSE(applied);
    EXPECT_EQ(applied.error().message, "widht: unknown; did you mean width?");
}

TEST(ClientMessages, EachWrongFieldIsNamed) {
    const std::vector<std::pair<const char*, const char*>> cases{
        {R"({})", "type"},
        {R"({"type": 5})", "type"},
        {R"({"type": "hallo"})", "type"},
        {R"({"type": "hello", "clowd": "x"})", "clowd"},
        {R"({"type": "hello", "width": 0})", "width"},
        {R"({"type": "hello", "height": 1e9})", "height"},
        {R"({"type": "hello", "fps": 0})", "fps"},
        {R"({"type": "hello", "fps": 1e300})", "fps"},
        {R"({"type": "hello", "pixelRatio": -1})", "pixelRatio"},
        {R"({"type": "hello", "cloud": 5})", "cloud"},
        {R"({"type": "hello", "resume": 5})", "resume"},
        {R"({"type": "view"})", "seq"},
        {R"({"type": "view", "seq": -1})", "seq"},
        {R"({"type": "view", "seq": 1.5})", "seq"},
        {R"({"type": "view", "seq": 1, "cloud": null})", "cloud"},
        {R"({"type": "quality", "fps": 1000})", "fps"},
        {R"({"type": "quality", "minResolution": 0})", "minResolution"},
        {R"({"type": "quality", "maxDetail": "2"})", "maxDetail"},
        {R"({"type": "quality", "minQuality": 0})", "minQuality"},
        {R"({"type": "quality", "maxQuality": 5})", "maxQuality"},
        {R"({"type": "pick", "x": 1})", "y"},
        {R"({"type": "pick", "x": -1, "y": 1})", "x"},
        {R"({"type": "ack"})", "frame"},
        {R"({"type": "ack", "frame": "1"})", "frame"},
        {R"({"type": "ping", "id": {}})", "id"},
    };
    for (const auto& [text, field] : cases) {
        const auto error = refused(text);
        EXPECT_EQ(error.code, ErrorCode::InvalidArgument) << text << ": " << error.message;
        EXPECT_EQ(error.field, field) << text << ": " << error.message;
    }
    EXPECT_NE(refused(R"({"type": "hallo"})").message.find("did you mean hello?"), std::string::npos);
}

TEST(ClientMessages, WhatIsNoObjectIsMalformed) {
    for (const auto* text : {"", "hello", "[]", "5", "null", "{\"type\":", "\xff"})
        EXPECT_EQ(refused(text).code, ErrorCode::Malformed) << text;
    EXPECT_EQ(refused(std::string(60'000, '[')).code, ErrorCode::Malformed);
}

TEST(ClientMessages, AckAndPingAreLenient) {
    EXPECT_TRUE(parseClientMessage(R"({"type": "ack", "frame": 1, "received": 12.5})"));
    EXPECT_TRUE(parseClientMessage(R"({"type": "ping", "note": "x"})"));
}

TEST(ServerMessages, RoundTrip) {
    Welcome welcome;
    welcome.session = "s1";
    welcome.resume = "r";
    welcome.resumed = true;
    welcome.seq = 12;
    welcome.cloud = "town";
    welcome.methods = {"point", "cone"};
    welcome.limits.maxPixels = 1u << 25u;
    welcome.view = toJson(View{});
    welcome.codecs = {"h264", "jpeg"};
    welcome.movingCodec = "h264";
    welcome.codecReason = "why";
    Stats stats{12,   34, 29.5,    1.25,   100'000,   2'000'000, 3, {{"select", 0.5}, {"encode", 2.25}},
                0.75, 63, 250'000, "cone", "why not", true};
    stats.color = "intensity";
    stats.colormap = "turbo";
    stats.range = {1.5, 200.0};
    const auto problem = problemOf(Error{ErrorCode::InvalidArgument, "no", "camera.fov"});
    const std::vector<ServerMessage> all{welcome,
                                         Stats{},
                                         stats,
                                         ProblemReport{5, problem},
                                         ProblemReport{{}, problem},
                                         Bye{CloseCode::GoingAway, "the server shuts down"},
                                         Drain{1200, 30'000},
                                         Picked{3, nullptr},
                                         Picked{4, {{"position", {1, 2, 3}}}},
                                         Pong{9}};
    for (const auto& message : all) {
        const auto text = printMessage(message);
        const auto back = parseServerMessage(text);
        ASSERT_TRUE(back) << text << ": " << back.error().message;
        EXPECT_EQ(*back, message) << text;
    }
}

TEST(ServerMessages, AreReadLeniently) {
    EXPECT_TRUE(parseServerMessage(R"({"type": "pong", "id": 1, "new": true})"));
    const auto unknown = parseServerMessage(R"({"type": "applause", "point": null})");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, ErrorCode::Unsupported);
}

TEST(ServerMessages, WrongOnesAreMalformed) {
    for (const auto* text :
         {"[]", "{}", R"({"type": 1})", R"({"type": "welcome"})",
          R"({"type": "welcome", "session": "s", "cloud": "c"})",
          R"({"type": "welcome", "session": "s", "cloud": "c", "view": 5})",
          R"({"type": "welcome", "session": "s", "cloud": "c", "view": {}, "methods": [1]})",
          R"({"type": "stats", "stages": {}})", R"({"type": "stats", "stages": [1]})",
          R"({"type": "stats", "fps": ""})", R"({"type": "problem"})", R"({"type": "problem", "problem": 5})",
          R"({"type": "bye", "code": 5})", R"({"type": "pong", "id": -1})"}) {
        const auto message = parseServerMessage(text);
        ASSERT_FALSE(message) << text;
        EXPECT_EQ(message.error().code, ErrorCode::Malformed) << text;
    }
}

}  // namespace
}  // namespace scancast
