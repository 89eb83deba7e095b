// Clients that are broken, slow, rude or gone: each costs itself its connection, and nobody else anything.
#include <thread>

#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

class HostileTest : public ServerTest {
  protected:
    void TearDown() override {
        EXPECT_EQ(request(port(), "/healthz").status, 200) << "the server must have survived";
    }
};

TEST_F(HostileTest, MalformedRequestsAreAnswered400AndClosed) {
    start();
    const std::string wrong[] = {
        "\r\n\r\n\r\n",
        "GET\r\n\r\n",
        "GET /healthz\r\n\r\n",
        "GET /healthz HTTP/9.9\r\n\r\n",
        "GET /health z HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "G\x01T / HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "GET / HTTP/1.1\r\nHost localhost\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: abc\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n",
        "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",  // a TLS hello
        "GET / HTTP/1.1\r\n\r\n",                        // no Host
        "GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n",
    };
    for (const std::string& bytes : wrong) {
        RawSocket socket(port());
        socket.send(bytes);
        const std::string reply = socket.receive(4096);
        EXPECT_EQ(reply.substr(0, 12), "HTTP/1.1 400") << bytes;
        EXPECT_NE(reply.find("application/problem+json"), std::string::npos) << bytes;
    }
}

// RFC 9112, 6.3: nobody can tell where such a request ends, and whoever guesses lets another one hide in it.
TEST_F(HostileTest, TransferEncodingsOtherThanChunkedAreRefusedAndClosed) {
    start();
    const std::string hidden = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
    const std::string length = "Content-Length: " + std::to_string(hidden.size()) + "\r\n";
    const std::string wrong[] = {"Transfer-Encoding: gzip\r\n",
                                 "Transfer-Encoding: gzip\r\n" + length,
                                 length + "Transfer-Encoding: identity\r\n",
                                 "Transfer-Encoding: chunked, gzip\r\n" + length,
                                 "Transfer-Encoding: gzip, chunked\r\n",
                                 "Transfer-Encoding: chunked, chunked\r\n",
                                 "Transfer-Encoding: chunked,\r\n",
                                 "Transfer-Encoding: ,chunked\r\n",
                                 "Transfer-Encoding: chunked;q=1\r\n",
                                 "Transfer-Encoding: \"chunked\"\r\n",
                                 "Transfer-Encoding: xchunked\r\n" + length,
                                 "Transfer-Encoding:\r\n" + length,
                                 "Transfer-Encoding: gzip\r\nTransfer-Encoding: chunked\r\n",
                                 "Transfer-Encoding: chunked\r\nTransfer-Encoding: gzip\r\n" + length,
                                 "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n",
                                 "Transfer-Encoding: chunked\r\nTransfer-Encoding:\r\n",
                                 "Transfer-Encoding: chunked\r\n" + length,
                                 length + "Transfer-Encoding: chunked\r\n",
                                 "Transfer-Encoding : chunked\r\n" + length};
    for (const std::string& fields : wrong) {
        for (const std::string& start :
             {std::string("POST /api/v1/clouds HTTP/1.1"), std::string("GET /healthz HTTP/1.1")}) {
            RawSocket socket(port());
            socket.send(start + "\r\nHost: localhost\r\nContent-Type: application/json\r\n" + fields +
                        "\r\n" + hidden);
            const std::string all = socket.receiveAll();
            EXPECT_EQ(all.substr(0, 12), "HTTP/1.1 400") << start << '\n' << fields;
            EXPECT_NE(all.find("Connection: close"), std::string::npos) << fields;
            EXPECT_EQ(all.find("\r\nContent-Length", all.find("\r\nContent-Length") + 1), std::string::npos)
                << "one answer, not two: " << fields << all;
        }
    }
    RawSocket old(port());
    old.send("GET /healthz HTTP/1.0\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n");
    EXPECT_EQ(old.receiveAll().substr(0, 12), "HTTP/1.1 400");
}

TEST_F(HostileTest, ChunkedBodiesAreRead) {
    options.tokens.admins = {{"admin", "admin-0123456789abcdef"}};
    start();
    for (const char* name : {"chunked", "Chunked", " chunked "}) {
        RawSocket socket(port());
        socket.send(
            "POST /api/v1/clouds HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer "
            "admin-0123456789abcdef\r\n"
            "Content-Type: application/json\r\nTransfer-Encoding:" +
            std::string(name) + "\r\n\r\n10\r\n{\"file\": \"a.las\"\r\n1\r\n}\r\n0\r\n\r\n");
        EXPECT_EQ(readReply(socket).status, 403) << name << ": understood, and refused without --data-root";
        EXPECT_EQ(requestOn(socket, "/healthz").status, 200) << "the next request begins behind it";
    }
}

TEST_F(HostileTest, LongHeadsAndTargets) {
    start();
    EXPECT_EQ(request(port(), "/" + std::string(9000, 'a')).status, 414);
    EXPECT_EQ(request(port(), "/", {"X-Long: " + std::string(20000, 'a')}).status, 431);
    EXPECT_EQ(request(port(), "/" + std::string(20000, 'a')).status, 431);
    RawSocket endless(port());
    endless.send("GET / HTTP/1.1\r\n");
    std::string all;
    for (int i = 0; i < 5000 && endless.send("X-H" + std::to_string(i) + ": v\r\n"); ++i) continue;
    EXPECT_EQ(endless.receive(12), "HTTP/1.1 431");
}

TEST_F(HostileTest, BodiesAreRefusedWithoutBeingRead) {
    start();
    RawSocket socket(port());
    socket.send("POST /api/v1/methods HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000000000\r\n\r\nx");
    const HttpReply reply = readReply(socket);
    EXPECT_EQ(reply.status, 405);
    EXPECT_EQ(reply.header("allow"), "GET, HEAD");
    EXPECT_EQ(reply.header("connection"), "close");
}

TEST_F(HostileTest, ARequestHiddenInABodyIsNotAnswered) {
    start();
    RawSocket socket(port());
    const std::string hidden = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
    socket.send("GET /nothing HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
                std::to_string(hidden.size()) + "\r\n\r\n" + hidden);
    const std::string all = socket.receiveAll();
    EXPECT_NE(all.find("404"), std::string::npos);
    EXPECT_EQ(all.find("200 OK"), std::string::npos);
}

TEST_F(HostileTest, SlowHeadsRunIntoTheirDeadline) {
    options.limits.requestTimeout = std::chrono::milliseconds(300);
    start();
    RawSocket socket(port());
    const auto begin = std::chrono::steady_clock::now();
    bool open = socket.send("GET / HTTP/1.1\r\n");
    // A byte now and then does not help: the deadline is for the whole head.
    while (open && std::chrono::steady_clock::now() - begin < netPatience) {
        open = socket.send("X");
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_FALSE(open);
}

TEST_F(HostileTest, IdleConnectionsAreClosed) {
    options.limits.requestTimeout = std::chrono::milliseconds(200);
    start();
    RawSocket socket(port());
    ASSERT_EQ(requestOn(socket, "/healthz").status, 200);
    EXPECT_TRUE(socket.receive(1).empty());
    EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
}

TEST_F(HostileTest, AbruptDisconnectsAtEveryStage) {
    start();
    for (int i = 0; i < 20; ++i) {
        { RawSocket(port()).abort(); }
        RawSocket half(port());
        half.send("GET /api/v1/clouds/one/snapshot.jpg HTTP/1.1\r\nHost: local");
        half.abort();
        RawSocket asked(port());
        asked.send("GET /api/v1/clouds/one/snapshot.jpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
        asked.abort();
        StreamClient upgraded(port());
        if (i % 2 == 0) upgraded.greet();
        if (i % 3 == 0) upgraded.view(1, 3);
        upgraded.socket.socket().abort();
    }
    EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
    EXPECT_TRUE(eventually([&] { return metric("scancast_sessions") == "scancast_sessions 0"; }));
}

TEST_F(HostileTest, AClientThatLeavesDuringItsStillFreesTheDevice) {
    painter.closeGate();
    start();
    {
        StreamClient client(port());
        client.greet();
        ASSERT_TRUE(painter.waitBegun(1));
        client.socket.socket().abort();
    }
    EXPECT_TRUE(eventually([&] { return painter.cancelled() == 1; }));
    painter.openGate();
}

TEST_F(HostileTest, WebSocketsThatBreakTheRules) {
    start();
    const auto codeAfter = [&](const std::function<void(RawWebSocket&)>& crime) {
        StreamClient client(port());
        client.greet();
        crime(client.socket);
        return client.closeCode();
    };
    EXPECT_EQ(codeAfter([](auto& s) { s.binary("abc"); }), 1003);
    EXPECT_EQ(codeAfter([](auto& s) { s.text("{no json"); }), 1007);
    EXPECT_EQ(codeAfter([](auto& s) { s.text("[1,2]"); }), 1007);
    EXPECT_EQ(codeAfter([](auto& s) { s.text("\"\xff\xfe\""); }), 1007);
    EXPECT_EQ(codeAfter([](auto& s) { s.text(std::string(200, '[')); }), 1007);
    EXPECT_EQ(codeAfter([](auto& s) { s.text(std::string(70000, ' ')); }), 1009);
    EXPECT_EQ(codeAfter([](auto& s) { s.text(R"({"type":"ack","frame":999})"); }), 1008);
    EXPECT_EQ(codeAfter([](auto& s) { s.frame(0x81, "{}", false); }), 1002);  // not masked
    EXPECT_EQ(codeAfter([](auto& s) { s.frame(0x83, "x"); }), 1002);          // reserved opcode
    EXPECT_EQ(codeAfter([](auto& s) { s.frame(0xf1, "x"); }), 1002);          // reserved bits
    EXPECT_EQ(codeAfter([](auto& s) { s.frame(0x80, "x"); }), 1002);          // continues nothing
}

TEST_F(HostileTest, AFragmentedMessageCountsAsAWhole) {
    start();
    StreamClient client(port());
    client.greet();
    client.socket.frame(0x01, R"({"type":"pi)");
    client.socket.frame(0x80, R"(ng","id":8})");
    EXPECT_EQ(client.control("pong")["id"], 8);
    const std::string part(30000, ' ');
    client.socket.frame(0x01, part);
    client.socket.frame(0x00, part);
    client.socket.frame(0x00, part);
    EXPECT_EQ(client.closeCode(), 1009);
}

TEST_F(HostileTest, HandshakesThatAreNone) {
    start();
    {
        RawWebSocket other(port(), "chat");
        EXPECT_EQ(other.receiveKind(WsMessage::Kind::Close).closeCode(), 1002);
        RawWebSocket none(port(), "");
        EXPECT_EQ(none.receiveKind(WsMessage::Kind::Close).closeCode(), 1002);
    }
    EXPECT_EQ(RawWebSocket(port(), "scancast.v1", {"Origin: http://evil.example"}).status(), 403);
    EXPECT_EQ(RawWebSocket(port(), "scancast.v1", {"Host: evil.example"}).status(), 403);
    EXPECT_EQ(RawWebSocket(port(), "chat, scancast.v1").status(), 101);
}

TEST_F(HostileTest, WhoNeverSaysHelloIsSentAway) {
    options.limits.helloTimeout = std::chrono::milliseconds(100);
    start();
    StreamClient client(port());
    EXPECT_EQ(client.closeCode(), 1008);
}

// Beast asserts, and a server that a client can have abort is none.
TEST_F(HostileTest, WhoAnswersACloseAndStaysOnTheLineIsCutOff) {
    options.limits.closeTimeout = std::chrono::milliseconds(100);
    start();
    std::vector<std::unique_ptr<StreamClient>> clients;
    for (int i = 0; i < 20; ++i) {
        clients.push_back(std::make_unique<StreamClient>(port()));
        clients.back()->greet();
        if (i % 2 == 0) {
            clients.back()->say({{"type", "ack"}, {"frame", 99}});  // never sent
            EXPECT_EQ(clients.back()->closeCode(), 1008);
        }
        clients.back()->socket.frame(0x88, std::string("\x03\xe8", 2));
    }
    EXPECT_TRUE(eventually([&] { return server->sessions() == 0 && server->connections() == 0; }));
    EXPECT_EQ(request(port(), "/healthz").status, 200);
}

TEST_F(HostileTest, WhoAsksAndNeverReadsIsSentAway) {
    options.limits.closeTimeout = std::chrono::milliseconds(300);
    start();
    StreamClient client(port());
    client.greet();
    // Answers pile up in the sockets' buffers first, then in the server's bounded queue; then the connection
    // ends.
    const std::string question = R"({"type":"view","seq":1,")" + std::string(3000, 'x') + R"(":1})";
    bool open = true;
    for (int i = 0; i < 200'000 && open; ++i) open = client.socket.text(question);
    EXPECT_FALSE(open);
    EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
}

TEST_F(HostileTest, AStormOfViewsFromManyClients) {
    start();
    std::vector<std::thread> crowd;
    std::atomic<int> finals{0};
    for (int c = 0; c < 8; ++c) {
        crowd.emplace_back([&, c] {
            StreamClient client(port());
            client.greet();
            for (std::uint64_t seq = 1; seq <= 200; ++seq) client.view(seq, double(c * 10 + 1));
            if (client.finalFrame(200)) ++finals;
        });
    }
    for (auto& thread : crowd) thread.join();
    EXPECT_EQ(finals, 8);
}

}  // namespace
}  // namespace scancast::test
