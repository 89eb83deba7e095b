// Who is let in: tokens and TLS, over real sockets, with our own client where it speaks TLS.
#include <filesystem>

#include "client/cpp/scancast_client.hpp"
#include "protocol/bearer.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/serving/test_certificate.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

const std::string token = "letmein-0123456789";
const std::string bearer = "Authorization: Bearer " + token;

class AccessTest : public ServerTest {
  protected:
    void SetUp() override { options.tokens.users = {{"user", token}}; }
};

TEST_F(AccessTest, OnlyThePageAndHealthAreThereForEverybody) {
    start();
    for (const char* target : {"/", "/main.js", "/healthz", "/readyz"})
        EXPECT_EQ(request(port(), target).status, 200) << target;
    for (const char* target : {"/metrics", "/api/v1/clouds", "/api/v1/clouds/one", "/api/v1/methods",
                               onePicture, "/api/v1/stream", "/api/v1/clouds/unknown"}) {
        const HttpReply refused = request(port(), target);
        EXPECT_EQ(refused.status, 401) << target;
        EXPECT_EQ(refused.header("www-authenticate"), R"(Bearer realm="scancast")") << target;
        EXPECT_EQ(parseJson(refused.body).value()["status"], 401) << target;
        EXPECT_EQ(request(port(), target, {"Authorization: Bearer wrong-0123456789"}).status, 401) << target;
        EXPECT_NE(request(port(), target, {bearer}).status, 401) << target;
    }
    EXPECT_EQ(request(port(), std::string("/api/v1/clouds?token=") + token).status, 401);
}

TEST_F(AccessTest, WhatNeedsATokenIsNotForSharedCaches) {
    start();
    EXPECT_EQ(request(port(), onePicture, {bearer}).header("cache-control"), "private, no-cache");
    EXPECT_EQ(request(port(), "/api/v1/clouds", {bearer}).header("cache-control"), "private, no-cache");
    EXPECT_EQ(request(port(), "/").header("cache-control"), "no-cache");
}

TEST_F(AccessTest, StreamsTakeTheTokenAsHeaderOrSubprotocol) {
    start();
    EXPECT_EQ(RawWebSocket(port()).status(), 401);
    EXPECT_EQ(RawWebSocket(port(), "scancast.v1", {bearer}).status(), 101);
    EXPECT_EQ(RawWebSocket(port(), "scancast.v1, " + bearerSubprotocol("wrong-0123456789")).status(), 401);
    const RawWebSocket offered(port(), "scancast.v1, " + bearerSubprotocol(token));
    EXPECT_EQ(offered.status(), 101);
    EXPECT_EQ(offered.reply().header("sec-websocket-protocol"), "scancast.v1")
        << "the other one stays unsaid";
}

TEST_F(AccessTest, WithAWithdrawnTokenNothingIsAnsweredAndItsStreamsEnd) {
    const std::string kept = "another-0123456789";
    options.tokens.users.push_back({"bob", kept});
    start();
    const std::string bearerOfBob = "Authorization: Bearer " + kept;
    const auto thereAre = [&](const char* sessions) {
        return request(port(), "/metrics", {bearerOfBob}).body.find(sessions) != std::string::npos;
    };
    const auto hello = [](RawWebSocket& socket) {
        socket.text(R"({"type":"hello","width":32,"height":16})");
        return socket.receiveKind(WsMessage::Kind::Text).payload;
    };
    RawWebSocket gone(port(), "scancast.v1", {bearer});
    RawWebSocket greeting(port(), "scancast.v1", {bearer});  // has not said hello
    RawWebSocket stays(port(), "scancast.v1", {bearerOfBob});
    RawSocket mjpeg(port());
    mjpeg.send("GET /api/v1/clouds/one/stream.mjpg?width=32&height=16 HTTP/1.1\r\nHost: localhost\r\n" +
               bearer + "\r\n\r\n");
    EXPECT_NE(hello(gone).find("welcome"), std::string::npos);
    EXPECT_NE(hello(stays).find("welcome"), std::string::npos);
    ASSERT_TRUE(eventually([&] { return thereAre("\nscancast_sessions 4\n"); }));

    server->replaceTokens({{{"bob", kept}}, {}});
    EXPECT_EQ(request(port(), "/api/v1/clouds", {bearer}).status, 401);
    for (RawWebSocket* socket : {&gone, &greeting}) {
        const WsMessage end = socket->receiveKind(WsMessage::Kind::Close);
        EXPECT_EQ(end.closeCode(), 1008);
        EXPECT_NE(end.payload.find("no longer one of this server's"), std::string::npos) << end.payload;
    }
    EXPECT_TRUE(eventually([&] { return thereAre("\nscancast_sessions 1\n"); })) << "the MJPEG stream, too";
    stays.text(R"({"type":"ping","id":7})");
    std::string answer;
    while (answer.find("pong") == std::string::npos) {
        const WsMessage message = stays.receiveKind(WsMessage::Kind::Text);
        ASSERT_EQ(message.kind, WsMessage::Kind::Text);
        answer = message.payload;
    }
    EXPECT_EQ(request(port(), "/api/v1/clouds", {bearerOfBob}).status, 200);
}

TEST_F(AccessTest, WhoTriesTokensIsSlowedDownAndARightOneIsAlwaysLetIn) {
    start();
    const std::string wrong = "Authorization: Bearer wrong-0123456789";
    for (int i = 0; i < 10; ++i) EXPECT_EQ(request(port(), "/api/v1/clouds", {wrong}).status, 401) << i;
    const HttpReply slowed = request(port(), "/api/v1/methods", {wrong});
    EXPECT_EQ(slowed.status, 429);
    EXPECT_GT(std::stoi("0" + slowed.header("retry-after")), 0);
    EXPECT_EQ(RawWebSocket(port(), "scancast.v1", {wrong}).status(), 429);
    EXPECT_EQ(request(port(), "/api/v1/clouds").status, 401) << "no token is no try";
    const HttpReply metrics = request(port(), "/metrics", {bearer});
    EXPECT_EQ(metrics.status, 200) << "from the same address";
    EXPECT_NE(metrics.body.find("\nscancast_failed_logins_total{reason=\"unknown\"} 12\n"),
              std::string::npos);
}

TEST_F(AccessTest, OfAProxysClientsEachHasHisOwnTries) {
    const std::vector<std::string> loopback{"127.0.0.1"};
    options.proxies = *TrustedProxies::parse(loopback);
    start();
    const auto triedBy = [&](const std::string& client) {
        return request(port(), "/api/v1/clouds",
                       {"Authorization: Bearer wrong-0123456789", "X-Forwarded-For: " + client})
            .status;
    };
    for (int i = 0; i < 10; ++i) EXPECT_EQ(triedBy("2001:db8::" + std::to_string(i)), 401) << i;
    EXPECT_EQ(triedBy("2001:db8::ffff"), 429) << "a network of 64 bits is one client";
    EXPECT_EQ(triedBy("192.0.2.7"), 401);
}

TEST_F(AccessTest, AllowedOriginsAreToldWhichHeadersTheyMaySend) {
    options.allowedOrigins = {"https://viewer.example"};
    start();
    const std::vector<std::string> asking{"Origin: https://viewer.example",
                                          "Access-Control-Request-Method: GET",
                                          "Access-Control-Request-Headers: authorization"};
    const HttpReply allowed = request(port(), "/api/v1/clouds", asking, "OPTIONS");
    EXPECT_EQ(allowed.status, 204);
    EXPECT_EQ(allowed.header("access-control-allow-origin"), "https://viewer.example");
    EXPECT_NE(allowed.header("access-control-allow-headers").find("Authorization"), std::string::npos);
    EXPECT_EQ(request(port(), "/api/v1/clouds",
                      {"Origin: https://evil.example", "Access-Control-Request-Method: GET"}, "OPTIONS")
                  .status,
              403);
}

TEST_F(AccessTest, MessagesBeforeTheHelloAreShort) {
    start();
    RawWebSocket early(port(), "scancast.v1", {bearer});
    early.text(R"({"type":"hello","cloud":")" + std::string(33'000, 'a') + "\"}");
    EXPECT_EQ(early.receiveKind(WsMessage::Kind::Close).closeCode(), 1009);
    RawWebSocket greeted(port(), "scancast.v1", {bearer});
    greeted.text(R"({"type":"hello","width":32,"height":16})");
    EXPECT_EQ(greeted.receive().kind, WsMessage::Kind::Text);
    greeted.text(R"({"type":"ping","id":7,"more":")" + std::string(33'000, 'a') + "\"}");
    std::string answer;
    while (answer.find("pong") == std::string::npos) {
        const WsMessage message = greeted.receiveKind(WsMessage::Kind::Text);
        ASSERT_EQ(message.kind, WsMessage::Kind::Text);
        answer = message.payload;
    }
}

class TlsTest : public ServerTest {
  protected:
    void SetUp() override {
        files = makeCertificate(folder, "server");
        options.tls = {files.certificate, files.key};
        options.tokens.users = {{"user", token}};
        credentials = {token, files.certificate};
    }
    client::ServerUrl url(const char* host = "localhost") const { return {host, port(), true}; }

    const TemporaryFolder folder;
    CertificateFiles files;
    client::Credentials credentials;
};

TEST_F(TlsTest, PicturesAndStreamsTravelEncrypted) {
    start();
    EXPECT_EQ(server->url().substr(0, 8), "https://");
    const client::Server rest(url(), {}, credentials);
    const auto clouds = rest.clouds();
    ASSERT_TRUE(clouds) << clouds.error().message;
    EXPECT_EQ(clouds->size(), 2U);
    const auto jpeg = rest.snapshot("one", {{"width", "300"}, {"height", "200"}});
    ASSERT_TRUE(jpeg) << jpeg.error().message;

    messages::Hello hello;
    hello.width = 64;
    hello.height = 48;
    auto stream = client::Stream::open(url("127.0.0.1"), hello, {}, credentials);
    ASSERT_TRUE(stream) << stream.error().message;
    auto frame = stream->receiveFrame();
    while (frame && !frame->header.final) {
        ASSERT_TRUE(stream->ack(frame->header));
        frame = stream->receiveFrame();
    }
    EXPECT_TRUE(frame);
    EXPECT_TRUE(stream->close());
}

TEST_F(TlsTest, ACertificateIsForItsNameAndSignedBySomebodyTrusted) {
    options.host = "0.0.0.0";  // 127.0.0.2 is this machine, too, and not in the certificate
    start();
    const auto strangers = makeCertificate(folder, "stranger");
    const auto untrusted = client::Server(url(), {}, {token, strangers.certificate}).clouds();
    ASSERT_FALSE(untrusted);
    EXPECT_EQ(untrusted.error().code, ErrorCode::Unsupported) << untrusted.error().message;
    EXPECT_FALSE(client::Server(url(), {}, {token, {}}).clouds());
    const auto misnamed = client::Server(url("127.0.0.2"), {}, credentials).clouds();
    ASSERT_FALSE(misnamed);
    EXPECT_EQ(misnamed.error().code, ErrorCode::Unsupported) << misnamed.error().message;
}

TEST_F(TlsTest, WhoSpeaksInTheClearIsNotAnswered) {
    start();
    EXPECT_EQ(request(port(), "/healthz").status, 0);
    RawSocket(port()).abort();
    const client::Server wrongToken(url(), {}, {"wrong-0123456789", files.certificate});
    EXPECT_FALSE(wrongToken.clouds()) << "and the server goes on";
    EXPECT_TRUE(client::Server(url(), {}, credentials).clouds());
}

}  // namespace
}  // namespace scancast::test
