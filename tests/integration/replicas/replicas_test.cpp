// Two servers that share nothing but a key, over real sockets: sessions that go on at the other one, tokens that must not be
// believed, and a server that leaves without losing anybody.
#include <gmock/gmock.h>

#include <set>

#include "client/cpp/scancast_client.hpp"
#include "server/access/guest_token.hpp"
#include "server/stream/session_token.hpp"
#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string annasToken = "Zk3vQ9xT1mB7nR4sW8yH2cL6pF0dJ5gA",
                  bertasToken = "q7Lw2NfXr5Yt8Ds1Gh4Jk6Mv9Bc3Pz0E";
const NamedToken sharedKey{"sessions", "Hn5tY8kP2wQ7zX4cV1bM9sD6fG3jL0rA"};

class ReplicasTest : public ServerTest {
  protected:
    /// Another server beside `server`, of the same clouds.
    void startBoth() {
        if (options.tokens.sessionKeys.empty()) options.tokens.sessionKeys = {sharedKey};
        start();
        auto created = ScancastServer::create(options, otherPainter.open());
        ASSERT_TRUE(created) << created.error().message;
        other = std::move(*created);
        other->catalog().setReady(other->catalog().add("one"), one);
        other->catalog().setReady(other->catalog().add("two"), two);
        other->scheduler().waitForDevice(netPatience);
    }
    static std::vector<std::string> bearer(const std::string& token) {
        return {"Authorization: Bearer " + token};
    }
    /// The hello of a client that has seen view `seq` of "two" from there, up to that frame.
    static json helloAgain(const std::string& token, std::uint64_t seq, double x, std::uint64_t frame = 0) {
        json hello = {
            {"type", "hello"},
            {"resume", token},
            {"cloud", "two"},
            {"seq", seq},
            {"view",
             {{"width", 64}, {"height", 48}, {"camera", {{"eye", {x, -50, 30}}, {"target", {5, 5, 0}}}}}}};
        if (frame > 0) hello["frame"] = frame;
        return hello;
    }
    static json greetWith(RawWebSocket& socket, const json& hello) {
        socket.text(hello.dump());
        const WsMessage message = socket.receiveKind(WsMessage::Kind::Text);
        return message.kind == WsMessage::Kind::Text ? json::parse(message.payload) : json();
    }

    FakePainter otherPainter;
    std::unique_ptr<ScancastServer> other;
};

TEST_F(ReplicasTest, ASessionGoesOnAtTheOtherServer) {
    startBoth();
    StreamClient client(port());
    const json welcome = client.greet({{"cloud", "two"}});
    client.view(5, 90);
    const auto shown = client.finalFrame(5);
    ASSERT_TRUE(shown);
    client.socket.socket().abort();
    StreamClient there(other->port());
    const json again = there.greet(helloAgain(welcome["resume"], 5, 90, shown->header.frameId));
    EXPECT_EQ(again["resumed"], true);
    EXPECT_EQ(again["session"], welcome["session"]);
    EXPECT_EQ(again["cloud"], "two");
    EXPECT_EQ(again["seq"], 5);
    const auto same = there.finalFrame(5);
    ASSERT_TRUE(same);
    EXPECT_EQ(same->picture, shown->picture);
    EXPECT_GT(same->header.frameId, shown->header.frameId) << "numbers go on";
    // And back, with the token of the other one: what the first remembers is older than what the client has seen.
    there.view(6, 30);
    const auto moved = there.finalFrame(6);
    ASSERT_TRUE(moved);
    StreamClient back(port());
    const json third = back.greet(helloAgain(again["resume"], 6, 30));
    EXPECT_EQ(third["resumed"], true);
    EXPECT_EQ(third["session"], welcome["session"]);
    const auto last = back.finalFrame(6);
    ASSERT_TRUE(last);
    EXPECT_EQ(last->picture, moved->picture);
}

TEST_F(ReplicasTest, WithoutASharedKeyItIsANewSessionThatShowsTheSame) {
    startBoth();
    server->replaceTokens({});  // and with them the key
    StreamClient client(port());
    const json welcome = client.greet({{"cloud", "two"}});
    StreamClient there(other->port());
    const json again = there.greet(helloAgain(welcome["resume"], 5, 90));
    EXPECT_EQ(again["resumed"], false);
    EXPECT_NE(again["session"], welcome["session"]);
    EXPECT_EQ(again["view"]["camera"]["eye"][0], 90);
    EXPECT_TRUE(there.finalFrame(5));
}

TEST_F(ReplicasTest, TokensOfAServersOwnKeyOutliveAReload) {
    start();
    StreamClient client(port());
    const json welcome = client.greet({{"cloud", "two"}});
    server->replaceTokens(options.tokens);  // as SIGHUP does, whether or not the files have changed
    client.socket.socket().abort();
    StreamClient back(port());
    EXPECT_EQ(back.greet({{"resume", welcome["resume"]}})["resumed"], true);
}

TEST_F(ReplicasTest, TheLargestViewThereIsIsReadInAHello) {
    startBoth();
    StreamClient client(port());
    const json welcome = client.greet({{"cloud", "two"}});
    json hello = helloAgain(welcome["resume"], 5, 90);
    hello["view"]["method"] = "auto";
    json& parameters = hello["view"]["param"] = json::object();
    for (int i = 10; i < 10 + 64; ++i)
        parameters[std::string(62, 'p') + std::to_string(i)] = std::string(256, 'v');
    for (int i = 0; i < 256; ++i) hello["view"]["classes"].push_back(i);
    ASSERT_GT(hello.dump().size(), 20'000U);
    hello["type"] = "hello";
    StreamClient there(other->port());
    there.say(hello);
    const json answer = there.control("problem");  // of what is in it, and no close with 1009
    ASSERT_TRUE(answer.is_object());
    EXPECT_NE(answer["problem"]["detail"].get<std::string>().find("unknown"), std::string::npos) << answer;
}

TEST_F(ReplicasTest, WhatIsTamperedWithExpiredOrAnothersIsANewSession) {
    options.tokens.users = {{"anna", annasToken}, {"berta", bertasToken}};
    startBoth();
    std::string token;
    {
        RawWebSocket anna(port(), "scancast.v1", bearer(annasToken));
        token = greetWith(anna, {{"type", "hello"}, {"cloud", "two"}})["resume"];
    }
    const auto resumed = [&](const std::string& with, const std::string& whose) {
        RawWebSocket client(other->port(), "scancast.v1", bearer(whose));
        const json welcome = greetWith(client, helloAgain(with, 1, 5));
        EXPECT_EQ(welcome["type"], "welcome");
        EXPECT_EQ(welcome["view"]["camera"]["eye"][0], 5) << "what it says is shown all the same";
        return welcome["resumed"] == true;
    };
    EXPECT_FALSE(resumed(token, bertasToken)) << "it is Anna's";
    EXPECT_TRUE(resumed(token, annasToken));
    SessionToken claim = parseSessionToken(token)->token;
    claim.turn = 5;  // the session has gone on here by now
    EXPECT_TRUE(resumed(signedToken(claim, sharedKey.token), annasToken));
    EXPECT_FALSE(resumed(signedToken(claim, annasToken), annasToken)) << "a key of one's own";
    claim.session = "s000000000000000000000000";
    const std::string others = signedToken(claim, "guessed");
    EXPECT_FALSE(resumed(others, annasToken));
    EXPECT_FALSE(resumed(token.substr(0, token.size() - 1), annasToken));
    claim.expires = 1'600'000'000;
    EXPECT_FALSE(resumed(signedToken(claim, sharedKey.token), annasToken));
}

TEST_F(ReplicasTest, AGuestsSessionIsHisAndOfHisCloudAlone) {
    const NamedToken guestKey{"guests", "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo"};
    options.tokens.users = {{"anna", annasToken}};
    options.tokens.guestKeys = {guestKey};
    startBoth();
    const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    const auto pass = [&](char link, const std::string& cloud) {
        return signedToken(GuestToken{guestKey.name, cloud, now + 3600, std::string(12, link), now + 600},
                           guestKey.token);
    };
    std::string token;
    {
        RawWebSocket guest(port(), "scancast.v1", bearer(pass('a', "two")));
        token = greetWith(guest, {{"type", "hello"}})["resume"];
    }
    const auto welcomed = [&](const std::string& whose, const std::string& cloud) {
        RawWebSocket client(other->port(), "scancast.v1", bearer(whose));
        json hello = helloAgain(token, 1, 5);
        hello["cloud"] = cloud;
        return greetWith(client, hello);
    };
    EXPECT_EQ(welcomed(pass('b', "two"), "two")["resumed"], false) << "another guest's";
    EXPECT_EQ(welcomed(annasToken, "two")["resumed"], false);
    const json elsewhere = welcomed(pass('a', "two"), "one");
    EXPECT_EQ(elsewhere["type"], "problem") << "another cloud is not there for him, with any token";
    EXPECT_EQ(elsewhere["problem"]["status"], 404);
    EXPECT_EQ(welcomed(pass('a', "two"), "two")["resumed"], true);
}

TEST_F(ReplicasTest, AReplayDisturbsNobody) {
    startBoth();
    StreamClient client(port());
    const json welcome = client.greet({{"cloud", "two"}});
    ASSERT_TRUE(client.finalFrame(0));
    StreamClient there(other->port());
    const json first = there.greet(helloAgain(welcome["resume"], 5, 90));
    StreamClient replay(other->port());
    const json second = replay.greet(helloAgain(welcome["resume"], 5, 90));
    EXPECT_EQ(second["resumed"], false);
    EXPECT_NE(second["session"], first["session"]);
    there.view(6, 30);
    EXPECT_TRUE(there.finalFrame(6)) << "who came first goes on";
    client.view(7, 20);
    EXPECT_TRUE(client.finalFrame(7)) << "and the other server knows nothing of it";
}

TEST_F(ReplicasTest, EqualTagsOnBoth) {
    startBoth();
    const HttpReply here = request(port(), onePicture), there = request(other->port(), onePicture);
    EXPECT_EQ(here.status, 200);
    EXPECT_EQ(here.header("etag"), there.header("etag"));
    EXPECT_EQ(here.body, there.body);
    EXPECT_EQ(request(other->port(), onePicture, {"If-None-Match: " + here.header("etag")}).status, 304);
    for (const char* same : {"/", "/main.js", "/openapi.json", "/api/v1/methods"}) {
        EXPECT_EQ(request(port(), same).header("etag"), request(other->port(), same).header("etag")) << same;
        EXPECT_EQ(request(port(), same).body, request(other->port(), same).body) << same;
    }
}

// Fifty people look when their server is told to go.
TEST_F(ReplicasTest, AServerThatLeavesLosesNobody) {
    options.limits.maxSessions = 100;
    startBoth();
    struct Viewer {
        std::unique_ptr<StreamClient> client, next;
        json welcome;
        std::optional<StreamClient::Frame> here;
    };
    std::vector<Viewer> viewers(50);
    for (std::size_t i = 0; i < viewers.size(); ++i) {
        Viewer& viewer = viewers[i];
        viewer.client = std::make_unique<StreamClient>(port());
        viewer.welcome = viewer.client->greet({{"cloud", "two"}});
        viewer.client->view(3, double(i));
    }
    for (Viewer& viewer : viewers) ASSERT_TRUE(viewer.client->finalFrame(3));
    EXPECT_EQ(metric("scancast_sessions"), "scancast_sessions 50");
    EXPECT_EQ(metric("scancast_draining"), "scancast_draining 0");
    server->moveClients(std::chrono::seconds(8));
    EXPECT_EQ(request(port(), "/readyz").status, 503);
    EXPECT_EQ(request(port(), "/healthz").status, 200);
    EXPECT_EQ(metric("scancast_draining"), "scancast_draining 1");
    EXPECT_EQ(request(port(), onePicture).status, 200) << "pictures are drawn for who asks";
    const RawWebSocket late(port());
    EXPECT_EQ(late.status(), 503);
    EXPECT_NE(late.reply().header("retry-after"), "");
    EXPECT_EQ(request(port(), "/api/v1/clouds/two/stream.mjpg").status, 503);
    std::set<std::uint64_t> times;
    for (Viewer& viewer : viewers) {
        const json drain = viewer.client->control("drain");
        ASSERT_TRUE(drain.is_object());
        const std::uint64_t after = drain["afterMilliseconds"];
        EXPECT_EQ(drain["withinMilliseconds"], 8000);
        EXPECT_LE(after, 4000U) << "so that who is refused can try again";
        times.insert(after);
    }
    EXPECT_EQ(times.size(), viewers.size()) << "one after the other";
    for (std::size_t i = 0; i < viewers.size(); ++i) viewers[i].client->view(4, double(i) + 1);
    for (std::size_t i = 0; i < viewers.size(); ++i) {
        Viewer& viewer = viewers[i];
        viewer.here = viewer.client->finalFrame(4);
        ASSERT_TRUE(viewer.here) << "whoever is still there is drawn for";
        viewer.next = std::make_unique<StreamClient>(other->port());
        const json welcome = viewer.next->greet(
            helloAgain(viewer.welcome["resume"], 4, double(i) + 1, viewer.here->header.frameId));
        EXPECT_EQ(welcome["resumed"], true);
        EXPECT_EQ(welcome["session"], viewer.welcome["session"]);
        viewer.client->socket.frame(0x88, std::string("\x03\xe8", 2));
        viewer.client.reset();
    }
    for (Viewer& viewer : viewers) {
        const auto same = viewer.next->finalFrame(4);
        ASSERT_TRUE(same);
        EXPECT_EQ(same->picture, viewer.here->picture);
        EXPECT_GT(same->header.frameId, viewer.here->header.frameId);
    }
    EXPECT_TRUE(eventually([&] { return server->sessions() == 0; }));
    server->drain();
    EXPECT_TRUE(eventually([&] { return server->drained(); }));
}

TEST_F(ReplicasTest, WhoComesInWithTheLastIsToldAtOnce) {
    startBoth();
    RawWebSocket early(port());
    server->moveClients(std::chrono::seconds(8));
    early.text(R"({"type":"hello"})");
    EXPECT_EQ(json::parse(early.receiveKind(WsMessage::Kind::Text).payload)["type"], "welcome");
    EXPECT_EQ(json::parse(early.receiveKind(WsMessage::Kind::Text).payload)["type"], "drain");
}

}  // namespace
}  // namespace scancast::test
