// Guests: a link, a pass for it, one cloud to look at, and an end - over real sockets.
#include <gmock/gmock.h>

#include "client/cpp/scancast_client.hpp"
#include "protocol/bearer.hpp"
#include "protocol/guests/guest.hpp"
#include "server/access/guest_token.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/clouds/photos_in_memory.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string userToken = "user-0123456789abcdef", adminToken = "admin-0123456789abcdef";
const NamedToken guestKey{"guests", "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo"};

std::string bearerOf(const std::string& token) {
    return "Authorization: Bearer " + token;
}

class GuestTest : public ServerTest {
  protected:
    void SetUp() override {
        options.tokens = {{{"user", userToken}}, {{"admin", adminToken}}, {guestKey}};
        start();
    }
    /// As an administrator gets it.
    json link(const std::string& cloud = "one") const {
        const HttpReply reply =
            post(port(), "/api/v1/guest-links", json{{"cloud", cloud}, {"expiresInSeconds", 3600}}.dump(),
                 {bearerOf(adminToken), sendsJson});
        EXPECT_EQ(reply.status, 200) << reply.body;
        EXPECT_EQ(reply.header("cache-control"), "no-store");
        return json::parse(reply.body);
    }
    HttpReply exchange(const std::string& token) const {
        return post(port(), "/api/v1/guest-session", json{{"token", token}}.dump(), {sendsJson});
    }
    std::string pass(const std::string& cloud = "one") const {
        return json::parse(exchange(link(cloud)["token"]).body)["token"];
    }
    /// A link whose time is over in so many seconds.
    static std::string linkThatEndsIn(int seconds) {
        const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
        return signedToken({guestKey.name, "one", now + seconds, std::string(12, 'i'), std::nullopt},
                           guestKey.token);
    }
    /// The problem that a stream's message brings.
    static json problemOf(StreamClient& stream, const json& message) {
        stream.say(message);
        return stream.control("problem")["problem"];
    }
};

TEST_F(GuestTest, ALinkIsExchangedForAPass) {
    const json made = link();
    EXPECT_EQ(made["path"], "/#guest=" + made["token"].get<std::string>());
    const HttpReply reply = exchange(made["token"]);
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_EQ(reply.header("cache-control"), "no-store");
    const json got = json::parse(reply.body);
    EXPECT_EQ(got["cloud"], "one");
    EXPECT_EQ(got["linkExpires"], made["expires"]);
    EXPECT_LE(got["expires"], got["linkExpires"]);
    EXPECT_LE(got["expiresInSeconds"], 3600);
    EXPECT_GT(got["expiresInSeconds"], 3000);
    EXPECT_EQ(request(port(), onePicture, {bearerOf(got["token"])}).status, 200);
    EXPECT_EQ(exchange(made["token"]).status, 200) << "again, as long as it lives";
}

TEST_F(GuestTest, OnlyAnAdministratorMakesLinksAndOnlyToCloudsThatAreThere) {
    const auto asked = [&](const json& body, const std::string& token) {
        return post(port(), "/api/v1/guest-links", body.dump(), {bearerOf(token), sendsJson});
    };
    const json sound{{"cloud", "one"}, {"expiresInSeconds", 60}};
    EXPECT_EQ(asked(sound, adminToken).status, 200);
    EXPECT_EQ(asked(sound, userToken).status, 403);
    EXPECT_EQ(asked(sound, pass()).status, 403);
    EXPECT_EQ(asked({{"cloud", "three"}, {"expiresInSeconds", 60}}, adminToken).status, 404);
    EXPECT_EQ(asked({{"cloud", "one"}}, adminToken).status, 400);
    EXPECT_EQ(asked({{"cloud", "one"}, {"expiresInSeconds", 59}}, adminToken).status, 400);
    EXPECT_EQ(asked({{"cloud", "one"}, {"expiresInSeconds", 31622401}}, adminToken).status, 400);
    server->replaceTokens({{{"user", userToken}}, {{"admin", adminToken}}, {}});
    const HttpReply none = asked(sound, adminToken);
    EXPECT_EQ(none.status, 409);
    EXPECT_THAT(none.body, HasSubstr("--guest-key-file"));
}

TEST_F(GuestTest, WhatIsNoLinkGetsNoPass) {
    const std::string sound = link()["token"];
    std::string forged = sound;
    forged.back() = forged.back() == 'A' ? 'B' : 'A';
    for (const std::string& wrong :
         {std::string("x"), std::string(), forged, pass(), userToken, adminToken}) {
        const HttpReply refused = exchange(wrong);
        EXPECT_EQ(refused.status, 401) << wrong;
        EXPECT_TRUE(wrong.empty() || refused.body.find("\"" + wrong) == std::string::npos)
            << "told to everybody";
    }
    EXPECT_EQ(request(port(), onePicture, {bearerOf(sound)}).status, 401) << "a link is no pass";
    EXPECT_EQ(exchange(linkThatEndsIn(0)).status, 401);
    EXPECT_EQ(post(port(), "/api/v1/guest-session", "{", {sendsJson}).status, 400);
    EXPECT_EQ(post(port(), "/api/v1/guest-session", R"({"token": 7})", {sendsJson}).status, 400);
    // Tries are counted: six, one, one, and these.
    HttpReply last;
    for (int i = 0; i < 10; ++i) last = exchange("x");
    EXPECT_EQ(last.status, 429);
    EXPECT_EQ(exchange(sound).status, 200) << "a right one is let in";
}

TEST_F(GuestTest, PhotosAreOfHisCloudAlone) {
    for (const char* id : {"shown", "hidden"})
        server->catalog().setReady(server->catalog().add(id), withPhotos(*one));
    const std::string guest = bearerOf(pass("shown"));
    const std::string asked = "X-Request-Id: the-same";
    for (const std::string rest : {"/photos", "/photos/0"}) {
        const HttpReply his = request(port(), "/api/v1/clouds/shown" + rest, {guest});
        EXPECT_EQ(his.status, 200) << rest;
        EXPECT_EQ(his.header("cache-control"), "private, no-cache") << "nor for shared caches";
        const HttpReply other = request(port(), "/api/v1/clouds/hidden" + rest, {guest, asked});
        HttpReply none = request(port(), "/api/v1/clouds/nobody" + rest, {guest, asked});
        EXPECT_EQ(other.status, 404) << rest;
        for (auto at = none.body.find("nobody"); at != std::string::npos; at = none.body.find("nobody"))
            none.body.replace(at, 6, "hidden");
        EXPECT_EQ(other.body, none.body) << "as one that was never there";
        EXPECT_EQ(request(port(), "/api/v1/clouds/shown" + rest).status, 401);
    }
}

TEST_F(GuestTest, OneCloudIsAllThatThereIs) {
    const std::string guest = bearerOf(pass());
    const json list = json::parse(request(port(), "/api/v1/clouds", {guest}).body);
    ASSERT_EQ(list["clouds"].size(), 1U);
    EXPECT_EQ(list["clouds"][0]["id"], "one");
    EXPECT_EQ(list["pending"].size(), 0U);
    for (const char* target :
         {"/api/v1/clouds/one", "/api/v1/clouds/one/views", "/api/v1/methods", onePicture, "/openapi.json",
          "/api/v1/clouds/one/snapshot.png?width=32&height=16"})
        EXPECT_EQ(request(port(), target, {guest}).status, 200) << target;
    EXPECT_EQ(post(port(), "/api/v1/clouds/one/pick",
                   R"({"view": {"width": 32, "height": 16}, "x": 3, "y": 4})", {guest, sendsJson})
                  .status,
              200);
    EXPECT_EQ(post(port(), "/api/v1/clouds/one/measure",
                   R"({"measure": "distance", "points": [[0, 0, 0], [1, 0, 0]]})", {guest, sendsJson})
                  .status,
              200);
    // The other one is answered as one that was never there.
    for (const std::string rest :
         {"", "/views", "/snapshot.jpg?width=32&height=16", "/snapshot.png", "/stream.mjpg"}) {
        const std::string asked = "X-Request-Id: the-same";
        const HttpReply other = request(port(), "/api/v1/clouds/two" + rest, {guest, asked});
        HttpReply none = request(port(), "/api/v1/clouds/six" + rest, {guest, asked});
        EXPECT_EQ(other.status, 404) << rest;
        for (auto at = none.body.find("six"); at != std::string::npos; at = none.body.find("six"))
            none.body.replace(at, 3, "two");
        EXPECT_EQ(other.body, none.body);
    }
    for (const std::string rest : {"/snapshot", "/pick", "/measure"})
        EXPECT_EQ(
            post(port(), "/api/v1/clouds/two" + rest, R"({"view": {}, "x": 3, "y": 4})", {guest, sendsJson})
                .status,
            404);
    const json none = json::parse(request(port(), "/api/v1/clouds", {bearerOf(pass("two"))}).body);
    EXPECT_EQ(none["clouds"][0]["id"], "two") << "each his own";
}

TEST_F(GuestTest, WhatChangesSomethingOrTellsOfOthersIsNotForGuests) {
    const std::string guest = bearerOf(pass());
    for (const char* target : {"/metrics", "/api/v1/sessions"})
        EXPECT_EQ(request(port(), target, {guest}).status, 403) << target;
    EXPECT_EQ(request(port(), "/api/v1/clouds/one", {guest}, "DELETE").status, 403);
    for (const char* target : {"/api/v1/clouds", "/api/v1/sessions/s1/view", "/api/v1/guest-links"})
        EXPECT_EQ(post(port(), target, "{}", {guest, sendsJson}).status, 403) << target;
}

TEST_F(GuestTest, AStreamShowsThatCloudAndFollowsNobody) {
    StreamClient leader(port(), "scancast.v1, " + bearerSubprotocol(userToken));
    const json theirs = leader.greet({{"cloud", "one"}});
    ASSERT_FALSE(theirs.is_null());
    StreamClient guest(port(), "scancast.v1, " + bearerSubprotocol(pass()));
    EXPECT_EQ(problemOf(guest, {{"type", "hello"}, {"cloud", "two"}})["status"], 404);
    EXPECT_EQ(problemOf(guest, {{"type", "hello"}, {"follow", theirs["session"]}})["status"], 422);
    const json welcome = guest.greet();
    EXPECT_EQ(welcome["cloud"], "one");
    ASSERT_TRUE(guest.finalFrame(0));
    EXPECT_EQ(problemOf(guest, {{"type", "view"}, {"seq", 1}, {"cloud", "two"}})["status"], 404);
    EXPECT_EQ(problemOf(guest, {{"type", "view"}, {"seq", 2}, {"follow", theirs["session"]}})["status"], 422);
    // Who drives his session shows him nothing else either.
    const std::string drive = "/api/v1/sessions/" + welcome["session"].get<std::string>() + "/view";
    EXPECT_EQ(post(port(), drive, R"({"cloud": "two"})", {bearerOf(userToken), sendsJson}).status, 404);
    EXPECT_EQ(
        post(port(), drive, R"({"camera": {"eye": [10, 0, 2]}})", {bearerOf(userToken), sendsJson}).status,
        200);
    EXPECT_EQ(
        request(port(), "/api/v1/clouds/one/stream.mjpg?session=" + theirs["session"].get<std::string>(),
                {bearerOf(pass())})
            .status,
        422);
}

TEST_F(GuestTest, AStreamEndsWithItsLink) {
    const HttpReply reply = exchange(linkThatEndsIn(3));
    ASSERT_EQ(reply.status, 200);
    const std::string token = json::parse(reply.body)["token"];
    StreamClient guest(port(), "scancast.v1, " + bearerSubprotocol(token));
    ASSERT_FALSE(guest.greet().is_null());
    const WsMessage end = guest.socket.receiveKind(WsMessage::Kind::Close);
    EXPECT_EQ(end.closeCode(), 1008);
    EXPECT_THAT(end.payload, HasSubstr("time of this guest's link is over"));
    EXPECT_EQ(request(port(), onePicture, {bearerOf(token)}).status, 401);
    EXPECT_EQ(RawWebSocket(port(), "scancast.v1, " + bearerSubprotocol(token)).status(), 401);
}

TEST_F(GuestTest, ALinkIsWithdrawnWithItsKey) {
    const std::string token = link()["token"], guest = pass();
    StreamClient stream(port(), "scancast.v1, " + bearerSubprotocol(guest));
    ASSERT_FALSE(stream.greet().is_null());
    const NamedToken next{"later", "Zk3_tP8wQd-1HvNx5yMjR2bFsLg7cUaE"};
    server->replaceTokens({{{"user", userToken}}, {{"admin", adminToken}}, {next, guestKey}});
    EXPECT_EQ(request(port(), onePicture, {bearerOf(guest)}).status, 200) << "the old key is still known";
    EXPECT_EQ(exchange(token).status, 200);
    const std::string newer = link()["token"];
    server->replaceTokens({{{"user", userToken}}, {{"admin", adminToken}}, {next}});
    EXPECT_EQ(stream.closeCode(), 1008);
    EXPECT_EQ(request(port(), onePicture, {bearerOf(guest)}).status, 401);
    EXPECT_EQ(exchange(token).status, 401);
    EXPECT_EQ(exchange(newer).status, 200) << "the first one signed it";
}

TEST_F(GuestTest, TheClientTakesALink) {
    const std::string address = "http://127.0.0.1:" + std::to_string(port());
    ASSERT_TRUE(client::isGuestLink(address + link()["path"].get<std::string>()));
    const auto entry = client::enterAsGuest(address + link()["path"].get<std::string>());
    ASSERT_TRUE(entry) << entry.error().message;
    EXPECT_FALSE(entry->mayExport) << "this server was started without --guests-may-export";
    EXPECT_EQ(entry->cloud, "one");
    const auto clouds = client::Server(entry->url, {}, entry->credentials).clouds();
    ASSERT_TRUE(clouds) << clouds.error().message;
    EXPECT_EQ(clouds->size(), 1U);
    auto stream = client::Stream::open(entry->url, {}, {}, entry->credentials);
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_EQ(stream->welcome().cloud, "one");
    const auto refused = client::enterAsGuest(address + "/#guest=scg1.secret");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, Not(HasSubstr("scg1.secret")));
    EXPECT_FALSE(client::isGuestLink(address + "/#cloud=one"));
}

}  // namespace
}  // namespace scancast::test
