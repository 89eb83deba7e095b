// Who is let in when many come, over real sockets: idle connections give way, busy ones do not, who is refused is told
// so, and probes are always answered.
#include <thread>

#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

class ConnectionsTest : public ServerTest {
  protected:
    ConnectionsTest() {
        options.limits.requestTimeout = netPatience;  // what is idle stays until it has to go
        const std::vector<std::string> proxies{"127.0.0.1"};
        trusted = *TrustedProxies::parse(proxies);
    }
    static std::string picture(int quality) {
        return "/api/v1/clouds/one/snapshot.jpg?width=32&height=16&quality=" + std::to_string(quality);
    }
    /// A connection whose request is not answered before the gate opens.
    RawSocket waiting(int quality, const std::string& headers = {}) const {
        RawSocket socket(port());
        socket.send("GET " + picture(quality) + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n");
        return socket;
    }
    bool allWait(int requests) const {
        const std::string line = "scancast_pictures_awaited " + std::to_string(requests);
        return eventually([&] { return probe("/metrics").body.find(line) != std::string::npos; });
    }
    void startWithProbes() {
        options.adminListen = ListenAddress{"127.0.0.1", 0};
        start();
    }
    HttpReply probe(const std::string& target, const std::vector<std::string>& headers = {}) const {
        return request(server->adminPort(), target, headers);
    }
    std::string count(const std::string& name) const {
        const std::string text = probe("/metrics").body;
        const auto at = text.find("\n" + name + " ");
        if (at == std::string::npos) return "";
        const auto value = at + name.size() + 2;
        return text.substr(value, text.find('\n', value) - value);
    }
    TrustedProxies trusted;
};

TEST_F(ConnectionsTest, FullTheOneThatIsIdleLongestGoes) {
    options.limits.maxConnections = 3;
    startWithProbes();
    RawSocket silent(port());  // never asks for anything
    ASSERT_TRUE(eventually([&] { return server->connections() > 0; }));
    StreamClient viewer(port());
    viewer.greet();
    RawSocket kept(port());
    ASSERT_EQ(requestOn(kept, "/healthz").status, 200);
    EXPECT_EQ(request(port(), "/healthz").status, 200) << "there is room for one more";
    EXPECT_TRUE(silent.receive(1).empty() && silent.atEnd()) << "which was the silent one's";
    EXPECT_EQ(requestOn(kept, "/healthz").status, 200) << "and nobody else's";
    EXPECT_EQ(count("scancast_connections_displaced_total"), "1");
    EXPECT_EQ(count("scancast_connections_refused_total{reason=\"full\"}"), "0");
    viewer.view(1, 3);
    EXPECT_TRUE(viewer.finalFrame(1));
}

TEST_F(ConnectionsTest, FullOfWorkWhoComesIsToldSoAndProbesAreAnswered) {
    options.limits.maxConnections = 3;
    painter.closeGate();
    startWithProbes();
    std::vector<RawSocket> busy;
    for (int i = 0; i < 2; ++i) busy.push_back(waiting(50 + i));
    StreamClient viewer(port());
    viewer.greet();
    ASSERT_TRUE(allWait(2));
    for (int i = 0; i < 3; ++i) {
        const HttpReply refused = request(port(), "/healthz");
        EXPECT_EQ(refused.status, 503);
        EXPECT_EQ(refused.header("retry-after"), "1");
        EXPECT_EQ(refused.header("connection"), "close");
        EXPECT_EQ(refused.header("content-type"), "application/problem+json");
        const auto problem = nlohmann::json::parse(refused.body);
        EXPECT_EQ(problem.at("status"), 503);
        EXPECT_NE(problem.at("detail").get<std::string>().find("--max-connections"), std::string::npos);
    }
    EXPECT_EQ(count("scancast_connections_refused_total{reason=\"full\"}"), "3");
    EXPECT_EQ(count("scancast_connections"), "3");
    EXPECT_EQ(probe("/healthz").status, 200);
    EXPECT_EQ(probe("/readyz").status, 200);
    painter.openGate();
    for (RawSocket& socket : busy) EXPECT_EQ(readReply(socket).status, 200);
    EXPECT_TRUE(eventually([&] { return request(port(), "/healthz").status == 200; })) << "they are idle now";
}

TEST_F(ConnectionsTest, OneAddressHasItsShareAndItsOwnIdleOnesGo) {
    options.limits.maxConnectionsPerAddress = 2;
    painter.closeGate();
    startWithProbes();
    RawSocket first = waiting(50), idle(port());
    ASSERT_TRUE(allWait(1));
    RawSocket second = waiting(51);
    ASSERT_TRUE(allWait(2)) << "in place of the idle one";
    EXPECT_TRUE(idle.receive(1).empty());
    const HttpReply refused = request(port(), "/healthz");
    EXPECT_EQ(refused.status, 429);
    EXPECT_EQ(refused.header("retry-after"), "1");
    EXPECT_NE(refused.body.find("--trusted-proxy"), std::string::npos) << refused.body;
    EXPECT_EQ(count("scancast_connections_refused_total{reason=\"address\"}"), "1");
    painter.openGate();
    EXPECT_EQ(readReply(first).status, 200);
    EXPECT_EQ(readReply(second).status, 200);
}

TEST_F(ConnectionsTest, BehindAProxyEachClientHasItsShare) {
    options.limits.maxConnectionsPerAddress = 1;
    options.proxies = trusted;
    painter.closeGate();
    startWithProbes();
    const std::string anna = "X-Forwarded-For: 198.51.100.1", ben = "Forwarded: for=\"198.51.100.2:4711\"";
    RawSocket first = waiting(50, anna + "\r\n");
    ASSERT_TRUE(allWait(1));
    RawSocket pooled(port());
    const HttpReply refused = requestOn(pooled, "/healthz", {anna});
    EXPECT_EQ(refused.status, 429);
    EXPECT_EQ(refused.header("retry-after"), "1");
    EXPECT_EQ(requestOn(pooled, "/healthz", {ben}).status, 200) << "the proxy's connection stays";
    EXPECT_EQ(RawWebSocket(port(), "scancast.v1", {anna}).status(), 429);
    StreamClient viewer(port());
    viewer.greet();  // the proxy's own
    EXPECT_EQ(requestOn(pooled, "/healthz").status, 200) << "which has no share";
    painter.openGate();
    EXPECT_EQ(readReply(first).status, 200);
    EXPECT_TRUE(eventually([&] { return requestOn(pooled, "/healthz", {anna}).status == 200; }));
}

TEST_F(ConnectionsTest, WhatPicturesCostIsCountedForWhomTheProxyNames) {
    options.costs = {.picture = 1000, .client = 1500, .total = 100'000};
    options.proxies = trusted;
    painter.closeGate();
    startWithProbes();
    const std::string large =
        "/api/v1/clouds/one/snapshot.jpg?method=paraboloid&width=3840&height=2160&samples=16";
    const std::string anna = "X-Forwarded-For: 6.6.6.6, 198.51.100.1";
    RawSocket first(port());
    first.send("GET " + large + " HTTP/1.1\r\nHost: localhost\r\n" + anna + "\r\n\r\n");
    ASSERT_TRUE(allWait(1));
    EXPECT_EQ(request(port(), large + "&quality=50", {anna}).status, 429);
    EXPECT_EQ(request(port(), large + "&quality=50", {"X-Forwarded-For: 7.7.7.7, 198.51.100.1"}).status, 429)
        << "what a client writes itself makes him nobody else";
    RawSocket second(port());
    second.send("GET " + large +
                "&quality=51 HTTP/1.1\r\nHost: localhost\r\nX-Forwarded-For: 198.51.100.2\r\n\r\n");
    EXPECT_TRUE(allWait(2));
    painter.openGate();
    EXPECT_EQ(readReply(first).status, 200);
    EXPECT_EQ(readReply(second).status, 200);
}

TEST_F(ConnectionsTest, NobodyElseNamesClients) {
    options.costs = {.picture = 1000, .client = 1500, .total = 100'000};
    painter.closeGate();
    startWithProbes();
    const std::string large =
        "/api/v1/clouds/one/snapshot.jpg?method=paraboloid&width=3840&height=2160&samples=16";
    RawSocket first(port());
    first.send("GET " + large + " HTTP/1.1\r\nHost: localhost\r\nX-Forwarded-For: 198.51.100.1\r\n\r\n");
    ASSERT_TRUE(allWait(1));
    EXPECT_EQ(request(port(), large + "&quality=50", {"X-Forwarded-For: 198.51.100.2"}).status, 429);
    painter.openGate();
    EXPECT_EQ(readReply(first).status, 200);
}

TEST_F(ConnectionsTest, TheAddressOfProbesHasNothingElse) {
    options.tokens.users = {{"user", "user-0123456789abcdef"}};
    options.allowedHosts = {"probes.example"};
    startWithProbes();
    EXPECT_EQ(probe("/healthz").status, 200);
    EXPECT_EQ(probe("/readyz").status, 200);
    EXPECT_EQ(probe("/metrics").status, 401) << "what needs a token there needs it here";
    EXPECT_EQ(probe("/metrics", {"Authorization: Bearer user-0123456789abcdef"}).status, 200);
    for (const char* target : {"/", "/api/v1/clouds", "/api/v1/stream", "/openapi.json", "/metrics/x"}) {
        const HttpReply reply = probe(target, {"Authorization: Bearer user-0123456789abcdef"});
        EXPECT_EQ(reply.status, 404) << target;
        EXPECT_NE(reply.body.find("--admin-listen"), std::string::npos) << reply.body;
    }
    EXPECT_EQ(probe("/healthz", {"Host: probes.example"}).status, 200);
    EXPECT_EQ(probe("/healthz", {"Host: evil.example"}).status, 403);
    EXPECT_EQ(probe("/healthz", {"Origin: http://evil.example"}).status, 403);
}

TEST_F(ConnectionsTest, ProbesAreAnsweredHoweverManyHangOn) {
    startWithProbes();
    std::vector<RawSocket> hanging;
    for (std::size_t i = 0; i < probeLimits.all + 8; ++i) {
        hanging.emplace_back(server->adminPort());
        hanging.back().send(i % 2 == 0 ? "GET /heal" : "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n");
    }
    EXPECT_EQ(probe("/healthz").status, 200);
    EXPECT_TRUE(eventually([&] { return server->connections() <= probeLimits.all; }));
}

TEST_F(ConnectionsTest, ProbesSayThatTheServerIsLeaving) {
    startWithProbes();
    server->drain();
    EXPECT_EQ(probe("/readyz").status, 503);
    EXPECT_EQ(probe("/healthz").status, 200);
    server->shutDown();
    EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
}

TEST_F(ConnectionsTest, AnAddressThatIsTakenIsSaidWithItsFlag) {
    startWithProbes();
    ServerOptions second;
    second.port = 0;
    second.adminListen = ListenAddress{"127.0.0.1", server->adminPort()};
    FakePainter other;
    const auto refused = ScancastServer::create(second, other.open());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message.rfind("--admin-listen: cannot listen on 127.0.0.1 port ", 0), 0U)
        << refused.error().message;
}

}  // namespace
}  // namespace scancast::test
