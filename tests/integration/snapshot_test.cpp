// POST /clouds/{id}/snapshot over a real socket: formats, bodies, and pictures that many ask for at once.
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <thread>

#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

constexpr const char* snapshotTarget = "/api/v1/clouds/one/snapshot";
const std::string small = R"({"width":32,"height":16})";

class SnapshotTest : public ServerTest {
  protected:
    HttpReply ask(const std::string& body, std::vector<std::string> headers = {}) const {
        headers.push_back(sendsJson);
        return post(port(), snapshotTarget, body, headers);
    }
};

std::span<const std::uint8_t> bytesOf(const HttpReply& reply) {
    return {reinterpret_cast<const std::uint8_t*>(reply.body.data()), reply.body.size()};
}

TEST_F(SnapshotTest, AcceptChoosesWhatComes) {
    start();
    const HttpReply jpeg = ask(small);
    EXPECT_EQ(jpeg.status, 200);
    EXPECT_EQ(jpeg.header("content-type"), "image/jpeg");
    EXPECT_EQ(jpeg.header("vary"), "Accept");
    EXPECT_NE(jpeg.header("server-timing").find("select;dur="), std::string::npos);
    EXPECT_EQ(jpeg.body, request(port(), "/api/v1/clouds/one/snapshot.jpg?width=32&height=16").body);

    const HttpReply png =
        ask(R"({"width":32,"height":16,"background":"transparent"})", {"Accept: image/png"});
    EXPECT_EQ(png.header("content-type"), "image/png");
    const auto decoded = decodePng(bytesOf(png));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->width, 32);

    const HttpReply depth = ask(small, {"Accept: application/octet-stream"});
    EXPECT_EQ(depth.header("content-type"), "application/octet-stream");
    EXPECT_EQ(depth.header("scancast-width"), "32");
    EXPECT_EQ(depth.header("scancast-height"), "16");
    ASSERT_EQ(depth.body.size(), std::size_t(32 * 16 * 4));
    float first = 0;
    std::memcpy(&first, depth.body.data(), sizeof first);
    EXPECT_EQ(first, 1.0F);  // what the fake device draws
    EXPECT_EQ(ask(small, {"Accept: text/html"}).status, 406);
}

TEST_F(SnapshotTest, EveryFormatHasATagOfItsOwnAndIsRevalidated) {
    start();
    std::set<std::string> tags;
    for (const char* accept : {"image/jpeg", "image/png", "application/octet-stream"}) {
        const std::string header = std::string("Accept: ") + accept;
        const std::string tag = ask(small, {header}).header("etag");
        tags.insert(tag);
        const auto rendered = painter.begun().size();
        EXPECT_EQ(ask(small, {header, "If-None-Match: " + tag}).status, 304);
        EXPECT_EQ(painter.begun().size(), rendered);
    }
    EXPECT_EQ(tags.size(), 3U);
}

TEST_F(SnapshotTest, EqualOnesAtOnceAreRenderedOnce) {
    painter.closeGate();
    start();
    std::vector<std::thread> crowd;
    std::atomic<int> good{0};
    for (int i = 0; i < 10; ++i) {
        crowd.emplace_back([&] {
            if (ask(small).status == 200) ++good;
        });
    }
    // Connected is not asked: a request that comes after the picture is done is drawn anew, and rightly so.
    EXPECT_TRUE(
        eventually([&] { return metric("scancast_pictures_awaited") == "scancast_pictures_awaited 10"; }));
    painter.openGate();
    for (auto& thread : crowd) thread.join();
    EXPECT_EQ(good, 10);
    EXPECT_EQ(painter.begun().size(), 1U);
    EXPECT_EQ(metric("scancast_pictures_awaited"), "scancast_pictures_awaited 0");
}

TEST_F(SnapshotTest, BodiesAreCheckedBeforeAnythingIsDrawn) {
    start();
    EXPECT_EQ(post(port(), snapshotTarget, small, {}).status, 415);
    EXPECT_EQ(post(port(), snapshotTarget, small, {"Content-Type: text/plain"}).status, 415);
    EXPECT_EQ(ask("").status, 400);
    EXPECT_EQ(ask("{").status, 400);
    EXPECT_EQ(ask("[]").status, 400);
    EXPECT_EQ(ask(std::string(100, '[')).status, 400);
    const HttpReply typo = ask(R"({"camera":{"fvo":3}})");
    EXPECT_EQ(typo.status, 400);
    EXPECT_EQ(parseJson(typo.body).value()["errors"][0]["parameter"], "camera.fvo");
    EXPECT_EQ(ask(R"({"camera":{"eye":[1,1,1],"target":[1,1,1]}})").status, 422);
    EXPECT_EQ(post(port(), "/api/v1/clouds/none/snapshot", small, {sendsJson}).status, 404);
    const HttpReply get = request(port(), snapshotTarget);
    EXPECT_EQ(get.status, 405);
    EXPECT_EQ(get.header("allow"), "POST");
    EXPECT_TRUE(painter.begun().empty());
}

TEST_F(SnapshotTest, LongBodiesAre413WhateverTheySayOfTheirLength) {
    start();
    RawSocket announced(port());
    announced.send(std::string("POST ") + snapshotTarget + " HTTP/1.1\r\nHost: localhost\r\n" + sendsJson +
                   "\r\nContent-Length: 1000000000\r\n\r\n{");
    const HttpReply reply = readReply(announced);
    EXPECT_EQ(reply.status, 413);
    EXPECT_EQ(reply.header("connection"), "close");
    RawSocket chunked(port());
    chunked.send(std::string("POST ") + snapshotTarget + " HTTP/1.1\r\nHost: localhost\r\n" + sendsJson +
                 "\r\nTransfer-Encoding: chunked\r\n\r\n");
    const std::string chunk = "4000\r\n" + std::string(0x4000, ' ') + "\r\n";
    for (int i = 0; i < 6; ++i) chunked.send(chunk);
    EXPECT_EQ(readReply(chunked).status, 413);
}

TEST_F(SnapshotTest, ChunkedAndExpectingBodiesAreRead) {
    start();
    RawSocket chunked(port());
    chunked.send(
        std::string("POST ") + snapshotTarget + " HTTP/1.1\r\nHost: localhost\r\n" + sendsJson +
        "\r\nTransfer-Encoding: chunked\r\n\r\n9\r\n{\"width\":\r\n10\r\n32,\"height\": 16}\r\n0\r\n\r\n");
    EXPECT_EQ(readReply(chunked).status, 200);
    EXPECT_EQ(requestOn(chunked, "/healthz").status, 200) << "the connection is kept";
    RawSocket expecting(port());
    expecting.send(std::string("POST ") + snapshotTarget + " HTTP/1.1\r\nHost: localhost\r\n" + sendsJson +
                   "\r\nExpect: 100-continue\r\nContent-Length: " + std::to_string(small.size()) +
                   "\r\n\r\n");
    EXPECT_EQ(expecting.receive(25), "HTTP/1.1 100 Continue\r\n\r\n");
    expecting.send(small);
    EXPECT_EQ(readReply(expecting).status, 200);
}

TEST_F(SnapshotTest, ABodyThatNeverComesRunsIntoTheDeadline) {
    options.limits.requestTimeout = std::chrono::milliseconds(300);
    start();
    RawSocket socket(port());
    socket.send(std::string("POST ") + snapshotTarget + " HTTP/1.1\r\nHost: localhost\r\n" + sendsJson +
                "\r\nContent-Length: 100\r\n\r\n{");
    EXPECT_TRUE(socket.receiveAll().empty());
    EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
}

TEST_F(SnapshotTest, NobodyReadsABodyWithoutAToken) {
    options.tokens.users = {{"user", "letmein-0123456789"}};
    start();
    RawSocket socket(port());
    socket.send(std::string("POST ") + snapshotTarget + " HTTP/1.1\r\nHost: localhost\r\n" + sendsJson +
                "\r\nContent-Length: 60000\r\n\r\n");
    EXPECT_EQ(readReply(socket).status, 401);
}

TEST_F(SnapshotTest, OfALiveCloudNothingIsKept) {
    start();
    Catalog& catalog = server->catalog();
    const std::string id = catalog.addLive("depth");
    const std::string target = "/api/v1/clouds/depth/snapshot.jpg?width=32&height=16";
    EXPECT_EQ(request(port(), target).status, 503) << "no frame has come";
    catalog.setLive(id, {}, tinyCloud(10));
    const HttpReply first = request(port(), target);
    ASSERT_EQ(first.status, 200);
    EXPECT_EQ(first.header("cache-control"), "no-store");
    EXPECT_EQ(request(port(), onePicture).header("cache-control"), "no-cache") << "of others as ever";
    catalog.setLive(id, {}, tinyCloud(20));
    const HttpReply second = request(port(), target);
    EXPECT_NE(second.header("etag"), first.header("etag"));
    EXPECT_EQ(second.header("cache-control"), "no-store");

    const auto clouds = nlohmann::json::parse(request(port(), "/api/v1/clouds").body)["clouds"];
    EXPECT_EQ(clouds.at(2)["live"]["state"], "running");
    EXPECT_FALSE(clouds.at(0).contains("live"));
}

}  // namespace
}  // namespace scancast::test
