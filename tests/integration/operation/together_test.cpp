// Several clouds in one view, over HTTP and over streams: which clouds a picture is ordered of, who may see them, and what happens
// when they go. The fake device draws one colour; what is drawn is tests/oracle/device/together_test.cpp.
#include <gmock/gmock.h>

#include "protocol/bearer.hpp"
#include "protocol/guests/guest.hpp"
#include "renderer/together/together.hpp"
#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string userToken = "user-0123456789abcdef", adminToken = "admin-0123456789abcdef";

class TogetherTest : public ServerTest {
  protected:
    TogetherTest() { painter.keepClouds(); }
    static std::string picture(const std::string& words, const std::string& cloud = "one") {
        return "/api/v1/clouds/" + cloud + "/snapshot.jpg?width=32&height=16&" + words;
    }
    HttpReply ask(const std::string& words) const { return request(port(), picture(words)); }
    static std::string field(const HttpReply& reply) {
        return parseJson(reply.body).value()["errors"][0]["parameter"];
    }
    /// What the last picture was drawn of.
    const Cloud& drawn() const { return *painter.begun().back().cloud; }
    std::vector<std::string> namesDrawn() const {
        std::vector<std::string> names;
        if (!drawn().together) return names;
        for (const TogetherMember& member : drawn().together->members) names.push_back(member.name);
        return names;
    }
};

TEST_F(TogetherTest, PicturesAreOrderedOfAllThatTheViewNames) {
    start();
    ASSERT_EQ(ask("with=two,shift:100:0:0,tint:ff0000;.,tint:00ff00").status, 200);
    EXPECT_EQ(namesDrawn(), (std::vector<std::string>{"one", "two"}));
    EXPECT_EQ(drawn().together->members[1].shift, glm::dvec3(100, 0, 0));
    EXPECT_EQ(drawn().together->members[0].tint, (Rgb8{0, 255, 0}));
    EXPECT_EQ(drawn().bounds[1], glm::dvec3(110, 10, 5));
    EXPECT_EQ(drawn().octree.roots(), 2U);
    EXPECT_EQ(drawn().points, 300U);
    // The camera that is left open looks at all of it.
    const View all = painter.begun().back().view;
    ASSERT_EQ(ask("").status, 200);
    EXPECT_FALSE(drawn().together);
    const View alone = painter.begun().back().view;
    EXPECT_GT(glm::distance(all.camera.eye, all.camera.target),
              3 * glm::distance(alone.camera.eye, alone.camera.target));
    const HttpReply posted =
        post(port(), "/api/v1/clouds/one/snapshot",
             R"({"width": 32, "height": 16, "color": "cloud", "with": [{"cloud": "two"}]})", {sendsJson});
    ASSERT_EQ(posted.status, 200) << posted.body;
    EXPECT_TRUE(drawn().together->byCloud);
    EXPECT_EQ(ask("color=cloud").status, 200) << "one cloud alone, too";
}

TEST_F(TogetherTest, TagsAreOfAllClouds) {
    start();
    const std::string words = "with=two";
    const std::string tag = ask(words).header("etag");
    EXPECT_EQ(ask(words).header("etag"), tag);
    EXPECT_EQ(request(port(), picture(words), {"If-None-Match: " + tag}).status, 304);
    EXPECT_NE(ask("with=two,shift:0:0:1").header("etag"), tag);
    EXPECT_NE(ask("with=two,hidden").header("etag"), tag);
    EXPECT_NE(ask("").header("etag"), tag);
    ASSERT_TRUE(server->catalog().replace("two", two, tinyCloud(201)));
    EXPECT_NE(ask(words).header("etag"), tag) << "another cloud has taken the name";
    EXPECT_EQ(drawn().points, 301U);
}

TEST_F(TogetherTest, RefusalsSayWhichCloudAndWhy) {
    start();
    const HttpReply none = ask("with=two;three");
    EXPECT_EQ(none.status, 404);
    EXPECT_EQ(field(none), "with");
    EXPECT_THAT(none.body, HasSubstr("three"));
    EXPECT_EQ(ask("with=two,sideways").status, 400);
    server->catalog().add("loading");
    const HttpReply later = ask("with=loading");
    EXPECT_EQ(later.status, 503);
    EXPECT_EQ(later.header("retry-after"), "1");
    server->catalog().setPreview("loading", tinyCloud(7));
    EXPECT_EQ(ask("with=loading").status, 200) << "coarsely";
    const auto in = [](int epsg) {
        auto cloud = std::make_shared<Cloud>(*tinyCloud(1));
        cloud->crsEpsg = epsg;
        return cloud;
    };
    server->catalog().setReady(server->catalog().add("west"), in(25832));
    server->catalog().setReady(server->catalog().add("east"), in(25833));
    const HttpReply other = request(port(), picture("with=east", "west"));
    EXPECT_EQ(other.status, 422);
    EXPECT_EQ(field(other), "with");
    EXPECT_THAT(other.body, HasSubstr("25833"));
    EXPECT_EQ(ask("with=east").status, 200) << "of one, nobody knows";
    const HttpReply picked = post(port(), "/api/v1/clouds/one/pick",
                                  R"({"view": {"with": [{"cloud": "none"}]}, "x": 1, "y": 1})", {sendsJson});
    EXPECT_EQ(picked.status, 404);
    EXPECT_EQ(field(picked), "view.with");
    const HttpReply measured = post(
        port(), "/api/v1/clouds/one/measure",
        R"({"measure": "volume", "points": [[0, 0], [9, 0], [0, 9]], "base": 0, "view": {"with": [{"cloud": "two"}]}})",
        {sendsJson});
    EXPECT_EQ(measured.status, 422) << "of one cloud, where it lies";
    EXPECT_EQ(field(measured), "view.with");
}

TEST_F(TogetherTest, PicksSayWhosePointItIs) {
    start();
    const json view{{"width", 32},
                    {"height", 16},
                    {"with", {{{"cloud", "."}, {"hidden", true}}, {{"cloud", "two"}, {"shift", {1, 2, 3}}}}}};
    const HttpReply reply =
        post(port(), "/api/v1/clouds/one/pick", json{{"view", view}, {"x", 3}, {"y", 4}}.dump(), {sendsJson});
    ASSERT_EQ(reply.status, 200) << reply.body;
    const json point = json::parse(reply.body);
    EXPECT_EQ(point["cloud"], "two");
    EXPECT_EQ(point["shift"], json({1.0, 2.0, 3.0}));
    EXPECT_EQ(point["position"], json({0.0, 0.0, 0.0})) << "where its file has it";
}

TEST_F(TogetherTest, GuestsSeeOneCloudWhateverTheyName) {
    options.tokens = {
        {{"user", userToken}}, {{"admin", adminToken}}, {{"guests", "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo"}}};
    start();
    const auto bearer = [](const std::string& token) { return "Authorization: Bearer " + token; };
    const json link =
        json::parse(post(port(), "/api/v1/guest-links", R"({"cloud": "one", "expiresInSeconds": 3600})",
                         {bearer(adminToken), sendsJson})
                        .body);
    const std::string pass =
        json::parse(post(port(), "/api/v1/guest-session", json{{"token", link["token"]}}.dump(), {sendsJson})
                        .body)["token"];
    EXPECT_EQ(request(port(), picture("with=two"), {bearer(userToken)}).status, 200);
    const std::string same = "X-Request-Id: the-same";
    const HttpReply hidden = request(port(), picture("with=two"), {bearer(pass), same});
    HttpReply none = request(port(), picture("with=six"), {bearer(pass), same});
    EXPECT_EQ(hidden.status, 404);
    for (auto at = none.body.find("six"); at != std::string::npos; at = none.body.find("six"))
        none.body.replace(at, 3, "two");
    EXPECT_EQ(hidden.body, none.body) << "as one that was never there";
    EXPECT_EQ(request(port(), picture("with=.,tint:ff0000"), {bearer(pass)}).status, 200);
    // In a stream, by himself and by who drives him.
    StreamClient guest(port(), "scancast.v1, " + bearerSubprotocol(pass));
    const json welcome = guest.greet();
    guest.say({{"type", "view"}, {"seq", 1}, {"with", {{{"cloud", "two"}}}}});
    EXPECT_EQ(guest.control("problem")["problem"]["status"], 404);
    const std::string drive = "/api/v1/sessions/" + welcome["session"].get<std::string>() + "/view";
    const HttpReply driven =
        post(port(), drive, R"({"with": [{"cloud": "two"}]})", {bearer(userToken), sendsJson});
    EXPECT_EQ(driven.status, 404) << driven.body;
    EXPECT_EQ(request(port(), "/api/v1/clouds/one/stream.mjpg?with=two", {bearer(pass)}).status, 404);
    for (const FakePainter::Painted& painted : painter.begun())
        if (painted.view.with.empty()) {
            EXPECT_FALSE(painted.cloud->together);
        }
}

TEST_F(TogetherTest, StreamsShowThemAndTellOfThoseThatGo) {
    start();
    StreamClient client(port());
    const json welcome =
        client.greet({{"cloud", "one"}, {"view", {{"with", {{{"cloud", "two"}, {"shift", {200, 0, 0}}}}}}}});
    EXPECT_EQ(welcome["view"]["with"][0]["cloud"], "two");
    ASSERT_TRUE(client.finalFrame(0));
    EXPECT_EQ(namesDrawn(), (std::vector<std::string>{"one", "two"}));
    EXPECT_GT(painter.begun().back().view.camera.target.x, 50) << "the camera sees both";
    client.say({{"type", "view"},
                {"seq", 1},
                {"with", {{{"cloud", "two"}, {"tint", "#0000ff"}}, {{"cloud", "."}, {"hidden", true}}}}});
    ASSERT_TRUE(client.finalFrame(1));
    EXPECT_TRUE(drawn().together->members[0].hidden);
    // Another cloud takes its name: it is shown.
    ASSERT_TRUE(server->catalog().replace("two", two, tinyCloud(201)));
    server->cloudsChanged();
    EXPECT_TRUE(eventually([&] { return drawn().points == 201; }));
    // It goes: the client is told, and sees what is left.
    server->catalog().remove("two");
    server->cloudsChanged();
    const json told = client.control("problem");
    EXPECT_EQ(told["problem"]["status"], 404);
    EXPECT_THAT(told["problem"]["detail"].get<std::string>(), HasSubstr("two"));
    EXPECT_TRUE(eventually([&] { return namesDrawn() == std::vector<std::string>{"one"}; }));
    client.say({{"type", "view"}, {"seq", 2}, {"with", nullptr}});
    ASSERT_TRUE(client.finalFrame(2));
    EXPECT_FALSE(drawn().together);
}

TEST_F(TogetherTest, WhoFollowsSeesThemToo) {
    start();
    StreamClient leader(port()), follower(port());
    const json welcome = leader.greet({{"cloud", "one"}, {"view", {{"with", {{{"cloud", "two"}}}}}}});
    ASSERT_TRUE(leader.finalFrame(0));
    const json theirs = follower.greet({{"follow", welcome["session"]}});
    EXPECT_EQ(theirs["view"]["with"][0]["cloud"], "two");
    ASSERT_TRUE(follower.finalFrame(0));
}

TEST_F(TogetherTest, FewAreKeptAndNoneOfWhatIsGone) {
    TogetherClouds kept;
    const auto pair = [&](double shift) {
        return std::vector<TogetherMember>{{.name = "one", .cloud = one},
                                           {.name = "two", .cloud = two, .shift = {shift, 0, 0}}};
    };
    const auto first = kept.of(pair(1), false).value();
    EXPECT_EQ(kept.of(pair(1), false).value(), first) << "the same one";
    EXPECT_NE(kept.of(pair(1), true).value(), first);
    for (int i = 2; i < 40; ++i) ASSERT_TRUE(kept.of(pair(i), false));
    EXPECT_EQ(kept.size(), TogetherClouds::most);
    EXPECT_NE(kept.of(pair(1), false).value(), first) << "the oldest went";
    EXPECT_EQ(kept.forget(two.get()).size(), TogetherClouds::most);
    EXPECT_EQ(kept.size(), 0U);
}

}  // namespace
}  // namespace scancast::test
