// What the log says of requests that a real server answers, refuses, loses and streams; and by which id it does.
#include "tests/integration/server_fixture.hpp"
#include "tests/support/serving/log_file.hpp"

namespace scancast::test {
namespace {

const std::string traceOfRequest = "0af7651916cd43dd8448eb211c80319c";

class RequestLogOfServer : public ServerTest {
  protected:
    RequestLogOfServer() { options.requestLog.writer = log.writer(); }
    void TearDown() override { server.reset(); }

    /// The one line of which `key` is `value`; null when there is none in time. A line may come after its answer.
    nlohmann::json line(const std::string& key, const nlohmann::json& value) const {
        nlohmann::json found;
        eventually([&] {
            for (const auto& event : log.events())
                if (event.contains(key) && event[key] == value) found = event;
            return !found.is_null();
        });
        return found;
    }

    LogFile log;
};

TEST_F(RequestLogOfServer, SaysWhatWasAskedAndHowItWasAnswered) {
    start();
    const HttpReply reply =
        request(port(), onePicture,
                {"X-Request-Id: pic-1", "traceparent: 00-" + traceOfRequest + "-b7ad6b7169203331-01"});
    ASSERT_EQ(reply.status, 200);
    EXPECT_EQ(reply.header("x-request-id"), "pic-1");
    const auto said = line("request", "pic-1");
    ASSERT_FALSE(said.is_null()) << log.text();
    EXPECT_EQ(said["path"], onePicture);
    EXPECT_EQ(said["route"], "/api/v1/clouds/{id}/snapshot.jpg");
    EXPECT_EQ(said["status"], 200);
    EXPECT_EQ(said["client"], "127.0.0.1");
    EXPECT_EQ(said["trace"], traceOfRequest);
    EXPECT_NE(said["span"], said["parent"]);
    EXPECT_TRUE(said.contains("price"));
    EXPECT_GT(said["bytes"], reply.body.size());
}

TEST_F(RequestLogOfServer, RefusalsNameTheirIdInTheProblemToo) {
    start();
    for (const std::string target :
         {"/nope", "/api/v1/clouds/none", "/api/v1/clouds/one/snapshot.jpg?wdith=3"}) {
        const HttpReply reply = request(port(), target, {"X-Request-Id: not one of ours"});
        const std::string id = reply.header("x-request-id");
        ASSERT_EQ(id.size(), 32u) << target;
        EXPECT_EQ(nlohmann::json::parse(reply.body)["requestId"], id);
        EXPECT_EQ(line("request", id)["status"], reply.status) << log.text();
    }
    EXPECT_EQ(log.text().find("not one of ours"), std::string::npos);
    RawSocket broken(port());
    broken.send("this is no request\r\n\r\n");
    const HttpReply reply = readReply(broken);
    const auto said = line("request", reply.header("x-request-id"));
    EXPECT_EQ(said["status"], 400) << log.text();
    EXPECT_FALSE(said.contains("path"));
}

TEST_F(RequestLogOfServer, HoldsNoSecrets) {
    options.tokens.users = {{"visitors", "the-token-of-everybody"}};
    start();
    request(port(), "/api/v1/clouds?token=the-token-of-everybody",
            {"Authorization: Bearer the-token-of-everybody", "X-Request-Id: one"});
    const auto said = line("request", "one");
    EXPECT_EQ(said["path"], "/api/v1/clouds?token=*");
    EXPECT_EQ(said["token"], "visitors") << "who it was, by name";
    EXPECT_EQ(log.text().find("everybody"), std::string::npos) << log.text();
}

TEST_F(RequestLogOfServer, OneIdIsNotKeptForTheNextRequest) {
    start();
    RawSocket socket(port());
    EXPECT_EQ(requestOn(socket, "/api/v1/methods", {"X-Request-Id: first"}).header("x-request-id"), "first");
    EXPECT_NE(requestOn(socket, "/api/v1/methods").header("x-request-id"), "first");
    EXPECT_EQ(requestOn(socket, "/nope", {"X-Request-Id: third"}).header("x-request-id"), "third");
}

TEST_F(RequestLogOfServer, WhoLeavesIsSaidToHaveLeft) {
    painter.closeGate();
    start();
    RawSocket socket(port());
    socket.send(std::string("GET ") + onePicture +
                " HTTP/1.1\r\nHost: localhost\r\nX-Request-Id: gone\r\n\r\n");
    ASSERT_TRUE(eventually(
        [&] { return metric("scancast_http_requests_in_flight") == "scancast_http_requests_in_flight 2"; }));
    socket.abort();
    const auto said = line("request", "gone");
    EXPECT_EQ(said["status"], 499) << log.text();
    EXPECT_EQ(said["bytes"], 0);
    painter.openGate();
}

TEST_F(RequestLogOfServer, AStreamIsALineAtEachEnd) {
    start();
    std::string session;
    {
        StreamClient client(port());
        session = client.greet().at("session");
        client.view(1, 20);
        ASSERT_TRUE(client.frame());
        EXPECT_FALSE(client.socket.reply().header("x-request-id").empty());
        const auto opened = line("event", "stream opened");
        EXPECT_EQ(opened["session"], session.substr(0, 8) + "…") << log.text();
        EXPECT_EQ(opened["request"], client.socket.reply().header("x-request-id"));
    }
    const auto ended = line("event", "stream ended");
    EXPECT_EQ(ended["note"], "left") << log.text();
    EXPECT_GE(ended["frames"], 1);
    EXPECT_GT(ended["bytes"], 100);
    EXPECT_EQ(log.text().find(session), std::string::npos) << "its key";
    {
        RawSocket reader(port());
        reader.send(
            "GET /api/v1/clouds/one/stream.mjpg?width=32&height=16 HTTP/1.1\r\nHost: "
            "localhost\r\nX-Request-Id: mj\r\n\r\n");
        EXPECT_FALSE(reader.receive(100).empty());
    }
    ASSERT_TRUE(eventually([&] { return log.events().size() == 4; })) << log.text();
    EXPECT_EQ(line("request", "mj")["event"], "stream ended");
    EXPECT_EQ(line("request", "mj")["route"], "/api/v1/clouds/{id}/stream.mjpg");
}

TEST_F(RequestLogOfServer, WhoFindsNoPlaceIsSaidOnceAndCounted) {
    options.limits.maxConnections = 1;
    start();
    StreamClient keeps(port());
    keeps.greet();
    for (int i = 0; i < 50; ++i) {
        RawSocket socket(port());
        const HttpReply reply = readReply(socket);
        EXPECT_EQ(reply.status, 503);
        EXPECT_FALSE(reply.header("x-request-id").empty());
    }
    ASSERT_TRUE(eventually([&] { return log.events().size() >= 6; }));
    EXPECT_EQ(log.events().size(), 6u) << "the stream, and five of fifty" << log.text();
}

}  // namespace
}  // namespace scancast::test
