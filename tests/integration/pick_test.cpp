// What lies under a pixel, over HTTP and over a stream. The fake device draws depth 1 everywhere, and the
// cloud has one point: what is tested is everything around the search itself (tests/oracle/pick).
#include <nlohmann/json.hpp>

#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

constexpr const char* pickTarget = "/api/v1/clouds/one/pick";

class PickTest : public ServerTest {
  protected:
    HttpReply ask(const nlohmann::json& body) const { return post(port(), pickTarget, body.dump(), {sendsJson}); }
};

const nlohmann::json view{{"width", 32}, {"height", 16}};

TEST_F(PickTest, AnswersThePointWithItsAttributes) {
    start();
    const HttpReply reply = ask({{"view", view}, {"x", 3}, {"y", 4.5}});
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_EQ(reply.header("content-type"), "application/json");
    const auto point = parseJson(reply.body).value();
    EXPECT_EQ(point["position"], nlohmann::json({0.0, 0.0, 0.0}));
    EXPECT_EQ(point["precision"], nlohmann::json({1.0, 1.0, 1.0}));
    EXPECT_EQ(point["depth"], 1.0);
    EXPECT_EQ(point["rgb"], nlohmann::json({0, 0, 0}));
    EXPECT_EQ(point["intensity"], 0);
    EXPECT_EQ(point["classification"], 0);
    EXPECT_TRUE(point.contains("className"));
    EXPECT_EQ(ask({{"x", 0}, {"y", 0}}).status, 200) << "the default view";
}

TEST_F(PickTest, WhatTheViewDoesNotDrawIsNothing) {
    start();
    nlohmann::json filtered = view;
    filtered["classes"] = {7};
    const HttpReply reply = ask({{"view", filtered}, {"x", 3}, {"y", 4}});
    EXPECT_EQ(reply.status, 200);
    EXPECT_EQ(reply.body, "null");
}

TEST_F(PickTest, RefusalsNameTheField) {
    start();
    const std::pair<nlohmann::json, const char*> wrong[] = {
        {{{"view", view}, {"x", 3}}, "y"},
        {{{"view", view}, {"x", 32}, {"y", 0}}, "x"},
        {{{"view", view}, {"x", 0}, {"y", -1}}, "y"},
        {{{"view", view}, {"x", 0}, {"y", 16}}, "y"},
        {{{"view", view}, {"x", "a"}, {"y", 0}}, "x"},
        {{{"view", {{"fvo", 1}}}, {"x", 0}, {"y", 0}}, "view.fvo"},
        {{{"view", 5}, {"x", 0}, {"y", 0}}, "view"},
        {{{"view", view}, {"x", 0}, {"y", 0}, {"z", 0}}, "z"},
    };
    for (const auto& [body, field] : wrong) {
        const HttpReply reply = ask(body);
        EXPECT_EQ(reply.status, 400) << body;
        EXPECT_EQ(parseJson(reply.body).value()["errors"][0]["parameter"], field) << body;
    }
    EXPECT_TRUE(painter.begun().empty());
    EXPECT_EQ(request(port(), pickTarget).header("allow"), "POST");
    EXPECT_EQ(post(port(), "/api/v1/clouds/none/pick", "{}", {sendsJson}).status, 404);
}

TEST_F(PickTest, StreamsPickInTheViewThatTheyAskedForLast) {
    start();
    StreamClient client(port());
    client.greet();
    client.say({{"type", "pick"}, {"seq", 9}, {"x", 63}, {"y", 47}});
    const auto picked = client.control("picked");
    EXPECT_EQ(picked["seq"], 9);
    EXPECT_EQ(picked["point"]["position"], nlohmann::json({0.0, 0.0, 0.0}));
    client.say({{"type", "pick"}, {"seq", 10}, {"x", 64}, {"y", 0}});
    const auto refused = client.control("problem");
    EXPECT_EQ(refused["seq"], 10);
    EXPECT_EQ(refused["problem"]["errors"][0]["parameter"], "x");
    client.say({{"type", "view"}, {"seq", 1}, {"cloud", "two"}, {"classes", {7}}});
    client.say({{"type", "pick"}, {"seq", 11}, {"x", 1}, {"y", 1}});
    EXPECT_EQ(client.control("picked")["point"], nullptr);
}

TEST_F(PickTest, AClientThatLeavesGetsNoAnswerAndLeavesNothing) {
    painter.closeGate();
    start();
    {
        StreamClient client(port());
        client.greet();
        client.say({{"type", "pick"}, {"seq", 1}, {"x", 1}, {"y", 1}});
        client.socket.socket().abort();
    }
    painter.openGate();
    EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
    EXPECT_EQ(ask({{"view", view}, {"x", 0}, {"y", 0}}).status, 200);
}

}  // namespace
}  // namespace scancast::test
