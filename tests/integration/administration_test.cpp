// What only the administrator's token opens: the list of sessions, and clouds that come and go.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/integration/server_fixture.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

const std::string user = "user-0123456789abcdef", admin = "admin-0123456789abcdef";

std::string withToken(const std::string& token) {
    return "Authorization: Bearer " + token;
}

class AdministrationTest : public ServerTest {
  protected:
    void SetUp() override {
        std::ofstream(folder / "church.las") << "points";
        options.dataRoot = folder;
        options.tokens.users = {{"user", user}};
        options.tokens.admins = {{"admin", admin}};
    }
    HttpReply add(const std::string& body, const std::string& token = admin) {
        return post(port(), "/api/v1/clouds", body, {withToken(token), sendsJson});
    }
    HttpReply remove(const std::string& id, const std::string& token = admin) {
        return request(port(), "/api/v1/clouds/" + id, {withToken(token)}, "DELETE");
    }
    nlohmann::json sessions() {
        return parseJson(request(port(), "/api/v1/sessions", {withToken(admin)}).body).value()["sessions"];
    }

    const TemporaryFolder folder;
};

TEST_F(AdministrationTest, OnlyTheAdminTokenAdministers) {
    start();
    EXPECT_EQ(request(port(), "/api/v1/sessions").status, 401);
    EXPECT_EQ(request(port(), "/api/v1/sessions", {withToken(user)}).status, 403);
    EXPECT_EQ(request(port(), "/api/v1/sessions", {withToken(admin)}).status, 200);
    EXPECT_EQ(add("{}", user).status, 403);
    EXPECT_EQ(remove("one", user).status, 403);
    EXPECT_EQ(request(port(), "/api/v1/clouds/one", {}, "DELETE").status, 401);
    EXPECT_EQ(request(port(), "/api/v1/clouds/one", {withToken(admin)}).status, 200);
}

TEST_F(AdministrationTest, TheListOfSessionsTellsWhoLooksAtWhat) {
    start();
    EXPECT_TRUE(sessions().empty());
    RawWebSocket stream(port(), "scancast.v1", {withToken(user)});
    stream.text(R"({"type":"hello","cloud":"two","width":32,"height":16})");
    ASSERT_EQ(stream.receiveKind(WsMessage::Kind::Binary).kind, WsMessage::Kind::Binary);
    const auto list = sessions();
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0]["client"], "websocket");
    EXPECT_EQ(list[0]["cloud"], "two");
    EXPECT_EQ(list[0]["frames"], 1);
    EXPECT_EQ(list[0]["view"]["width"], 32);
    EXPECT_TRUE(list[0]["follows"].is_null());
    stream.socket().abort();
    EXPECT_TRUE(eventually([&] { return sessions().empty(); }));
}

TEST_F(AdministrationTest, ACloudIsAddedInTheBackground) {
    start();
    std::vector<std::string> loaded;
    server->admin().loadWith([&](const ScanInput& input, const std::string& id) {
        loaded.push_back(input.path().filename().string() + " " + id);
        return true;
    });
    const HttpReply added = add(R"({"file": "church.las", "title": "Our church"})");
    EXPECT_EQ(added.status, 202) << added.body;
    EXPECT_EQ(added.header("location"), "/api/v1/clouds/church");
    EXPECT_EQ(parseJson(added.body).value()["state"], "loading");
    EXPECT_THAT(loaded, ::testing::ElementsAre("church.las church"));
    EXPECT_EQ(remove("church").status, 409);
    server->catalog().setReady("church", tinyCloud());
    EXPECT_EQ(parseJson(request(port(), added.header("location"), {withToken(user)}).body).value()["title"],
              "Our church");
    const std::pair<const char*, int> wrong[] = {
        {R"({"file": "../church.las"})", 403},
        {R"({"file": "none.las"})", 404},
        {R"({"file": "church.las", "id": "church"})", 409},
        {R"({"file": "church.las", "id": "a b"})", 400},
        {R"({"fiel": "church.las"})", 400},
        {R"({)", 400},
    };
    for (const auto& [body, status] : wrong) EXPECT_EQ(add(body).status, status) << body;
    EXPECT_EQ(post(port(), "/api/v1/clouds", "{}", {withToken(admin)}).status, 415);
    server->admin().loadWith({});
}

TEST_F(AdministrationTest, ARemovedCloudIsGoneForEverybodyWhoLooksAtIt) {
    start();
    server->catalog().setReady(server->catalog().add("short"), tinyCloud(50));
    const std::weak_ptr<const Cloud> watched = server->catalog().cloud("short").value();
    RawWebSocket looking(port(), "scancast.v1", {withToken(user)});
    RawWebSocket elsewhere(port(), "scancast.v1", {withToken(user)});
    looking.text(R"({"type":"hello","cloud":"short","width":32,"height":16})");
    elsewhere.text(R"({"type":"hello","cloud":"two","width":32,"height":16})");
    for (RawWebSocket* stream : {&looking, &elsewhere})
        ASSERT_EQ(stream->receiveKind(WsMessage::Kind::Binary).kind, WsMessage::Kind::Binary);
    EXPECT_EQ(remove("short").status, 204);
    std::string texts;
    WsMessage message = looking.receive();
    for (; message.kind == WsMessage::Kind::Text; message = looking.receive()) texts += message.payload;
    EXPECT_THAT(texts, ::testing::HasSubstr("short"));
    EXPECT_THAT(texts, ::testing::HasSubstr("removed"));
    EXPECT_EQ(message.closeCode(), 1001);
    looking.socket().abort();
    EXPECT_TRUE(eventually([&] { return watched.expired(); })) << "its memory is free";
    EXPECT_EQ(request(port(), "/api/v1/clouds/short", {withToken(user)}).status, 404);
    EXPECT_EQ(remove("short").status, 404);
    elsewhere.text(R"({"type":"ping","id":3})");
    // Statistics may come first, where all of this took a second.
    WsMessage answer = elsewhere.receiveKind(WsMessage::Kind::Text);
    while (answer.kind == WsMessage::Kind::Text && answer.payload.find("pong") == std::string::npos)
        answer = elsewhere.receiveKind(WsMessage::Kind::Text);
    EXPECT_THAT(answer.payload, ::testing::HasSubstr("pong"));
}

}  // namespace
}  // namespace scancast::test
