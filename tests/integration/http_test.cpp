// Every route over a real socket, and what HTTP asks of a server beyond them.
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/integration/server_fixture.hpp"
#include "tests/support/clouds/photos_in_memory.hpp"

namespace scancast::test {
namespace {

class HttpTest : public ServerTest {};

TEST_F(HttpTest, EveryRouteAnswers) {
    start();
    const std::tuple<const char*, int, const char*> routes[] = {
        {"/", 200, "text/html; charset=utf-8"},
        {"/healthz", 200, "text/plain; charset=utf-8"},
        {"/readyz", 200, "text/plain; charset=utf-8"},
        {"/metrics", 200, "text/plain; version=0.0.4; charset=utf-8"},
        {"/api/v1/clouds", 200, "application/json"},
        {"/api/v1/clouds/one", 200, "application/json"},
        {"/api/v1/methods", 200, "application/json"},
        {onePicture, 200, "image/jpeg"},
        {"/api/v1/clouds/two/snapshot.png?width=5&height=5", 200, "image/png"},
        {"/api/v1/stream", 426, "application/problem+json"},
        {"/api/v1/clouds/three", 404, "application/problem+json"},
        {"/teapot", 404, "application/problem+json"},
    };
    for (const auto& [target, status, type] : routes) {
        const HttpReply reply = request(port(), target);
        EXPECT_EQ(reply.status, status) << target;
        EXPECT_EQ(reply.header("content-type"), type) << target;
        EXPECT_EQ(reply.header("x-content-type-options"), "nosniff") << target;
        EXPECT_EQ(reply.header("content-length"), std::to_string(reply.body.size())) << target;
    }
    EXPECT_EQ(metric("scancast_points_resident"), "scancast_points_resident 300");
    EXPECT_EQ(metric("scancast_http_requests_total{code=\"404\",route=\"/api/v1/clouds/{id}\"}"),
              "scancast_http_requests_total{code=\"404\",route=\"/api/v1/clouds/{id}\"} 1");
}

TEST_F(HttpTest, EveryFileOfThePageIsServed) {
    start();
    // The page names its own parts; each must be there.
    const std::string page = request(port(), "/").body;
    std::size_t found = 0;
    for (const char* attribute : {"src=\"", "href=\""}) {
        for (std::size_t at = page.find(attribute); at != std::string::npos;
             at = page.find(attribute, at + 1)) {
            const std::size_t begin = at + std::string(attribute).size();
            std::string path = page.substr(begin, page.find('"', begin) - begin);
            if (path.empty() || path[0] == '#' || path.find("://") != std::string::npos ||
                path.rfind("data:", 0) == 0)
                continue;
            if (path.rfind("./", 0) == 0) path = path.substr(1);
            if (path[0] != '/') path = "/" + path;
            EXPECT_EQ(request(port(), path).status, 200) << path;
            ++found;
        }
    }
    EXPECT_GT(found, 0U);
}

TEST_F(HttpTest, HeadIsGetWithoutItsBody) {
    start();
    RawSocket socket(port());
    const HttpReply head = requestOn(socket, "/api/v1/clouds", {}, "HEAD");
    const HttpReply get =
        requestOn(socket, "/api/v1/clouds");  // the same connection: a stray body would show here
    EXPECT_EQ(head.status, 200);
    EXPECT_EQ(head.header("content-length"), std::to_string(get.body.size()));
    EXPECT_TRUE(head.body.empty());
    const HttpReply pictureHead = requestOn(socket, onePicture, {}, "HEAD");
    EXPECT_EQ(pictureHead.status, 200);
    EXPECT_EQ(pictureHead.header("etag"), requestOn(socket, onePicture).header("etag"));
}

TEST_F(HttpTest, APhotoIsItsFilesBytesAndAHeadSaysHowMany) {
    start();
    auto cloud = std::make_shared<Cloud>(*one);
    const std::vector<std::byte> large = photoBytes(Photo::Format::Png, 3'000'001, 7);
    cloud->photos = {photoOf(Photo::Format::Png, large)};
    server->catalog().setReady(server->catalog().add("office"), cloud);
    const std::string address = "/api/v1/clouds/office/photos/0";
    RawSocket socket(port());
    std::string tag;
    for (int time = 0; time < 2; ++time) {  // its tag is not known yet, and it is
        const HttpReply head = requestOn(socket, address, {}, "HEAD");
        EXPECT_EQ(head.status, 200);
        EXPECT_EQ(head.header("content-type"), "image/png");
        EXPECT_EQ(head.header("content-length"), "3000001");
        EXPECT_EQ(head.header("x-content-type-options"), "nosniff");
        tag = head.header("etag");
    }
    const HttpReply photo = requestOn(socket, address);
    EXPECT_EQ(photo.status, 200);
    EXPECT_EQ(photo.header("etag"), tag);
    ASSERT_EQ(photo.body.size(), large.size());
    EXPECT_EQ(std::memcmp(photo.body.data(), large.data(), large.size()), 0);
    const HttpReply same = requestOn(socket, address, {"If-None-Match: " + tag});
    EXPECT_EQ(same.status, 304);
    EXPECT_TRUE(same.header("content-length").empty());
    EXPECT_EQ(requestOn(socket, address + "1").status, 404) << "the connection goes on";
    EXPECT_TRUE(eventually([&] {
        return metric("scancast_http_requests_total{code=\"200\",route=\"/api/v1/clouds/{id}/photos/{n}\"}")
            .ends_with(" 3");
    })) << "the number of a photo is no label";
}

TEST_F(HttpTest, RevalidationIsAnsweredWithoutRendering) {
    start();
    RawSocket socket(port());
    const HttpReply first = requestOn(socket, onePicture);
    ASSERT_EQ(first.status, 200);
    const auto rendered = painter.begun().size();
    const HttpReply second = requestOn(socket, onePicture, {"If-None-Match: " + first.header("etag")});
    EXPECT_EQ(second.status, 304);
    EXPECT_TRUE(second.header("content-length").empty());
    EXPECT_EQ(painter.begun().size(), rendered);
    EXPECT_EQ(requestOn(socket, onePicture).body, first.body);
}

TEST_F(HttpTest, ConnectionsAreKeptAndClosedAsAsked) {
    start();
    RawSocket socket(port());
    for (int i = 0; i < 5; ++i) EXPECT_EQ(requestOn(socket, "/healthz").status, 200);
    EXPECT_EQ(requestOn(socket, "/healthz", {"Connection: close"}).header("connection"), "close");
    EXPECT_TRUE(socket.receive(1).empty());
}

TEST_F(HttpTest, PipelinedRequestsAreAnsweredInOrder) {
    start();
    RawSocket socket(port());
    const std::string head = " HTTP/1.1\r\nHost: localhost\r\n";
    socket.send("GET /healthz" + head + "\r\nGET /nothing" + head + "\r\nGET /readyz" + head +
                "Connection: close\r\n\r\n");
    const std::string all = socket.receiveAll();
    const auto a = all.find("HTTP/1.1 200");
    const auto b = all.find("HTTP/1.1 404");
    const auto c = all.find("HTTP/1.1 200", b);
    EXPECT_LT(a, b);
    EXPECT_LT(b, c);
    EXPECT_NE(c, std::string::npos);
}

TEST_F(HttpTest, FiftySnapshotsAtOnceAllSucceed) {
    start();
    std::vector<std::thread> crowd;
    std::atomic<int> good{0};
    for (int i = 0; i < 50; ++i) {
        crowd.emplace_back([&, i] {
            const int width = 16 + i;
            const HttpReply reply =
                request(port(), "/api/v1/clouds/one/snapshot.png?height=8&width=" + std::to_string(width));
            const auto decoded =
                decodePng({reinterpret_cast<const std::uint8_t*>(reply.body.data()), reply.body.size()});
            if (reply.status == 200 && decoded && decoded->width == width) ++good;
        });
    }
    for (auto& thread : crowd) thread.join();
    EXPECT_EQ(good, 50);
}

TEST_F(HttpTest, TooManySnapshotsAreAskedToComeBack) {
    options.scheduler.maxSnapshots = 2;
    painter.closeGate();
    start();
    std::vector<std::thread> crowd;
    std::atomic<int> served{0};
    std::atomic<int> refused{0};
    std::atomic<int> number{0};  // equal pictures would share one place
    const auto ask = [&] {
        const HttpReply reply = request(
            port(), "/api/v1/clouds/one/snapshot.jpg?height=8&width=" + std::to_string(16 + number++));
        if (reply.status == 200) ++served;
        if (reply.status == 503 && !reply.header("retry-after").empty()) ++refused;
    };
    crowd.emplace_back(ask);
    ASSERT_TRUE(painter.waitBegun(1));  // it renders, so it waits no more
    for (int i = 0; i < 7; ++i) crowd.emplace_back(ask);
    EXPECT_TRUE(eventually([&] { return refused >= 5; }));  // one renders, two wait
    painter.openGate();
    for (auto& thread : crowd) thread.join();
    EXPECT_EQ(served, 3);
    EXPECT_EQ(refused, 5);
}

TEST_F(HttpTest, ASnapshotThatTakesTooLongIs504) {
    options.scheduler.snapshotDeadline = std::chrono::milliseconds(50);
    painter.closeGate();
    start();
    const HttpReply reply = request(port(), onePicture);
    EXPECT_EQ(reply.status, 504);
    EXPECT_EQ(parseJson(reply.body).value()["status"], 504);
}

TEST_F(HttpTest, PicturesAreLimited) {
    options.limits.maxPixels = 1000;
    start();
    EXPECT_EQ(request(port(), "/api/v1/clouds/one/snapshot.jpg?width=20&height=50").status, 200);
    EXPECT_EQ(request(port(), "/api/v1/clouds/one/snapshot.jpg?width=20&height=51").status, 413);
}

TEST_F(HttpTest, HostAndOriginAreCheckedOnEveryRoute) {
    options.allowedOrigins = {"https://viewer.example"};
    start();
    for (const char* target : {"/", "/healthz", "/metrics", "/api/v1/clouds", onePicture, "/nothing"}) {
        EXPECT_EQ(request(port(), target, {"Host: evil.example"}).status, 403) << target;
        EXPECT_EQ(request(port(), target, {"Origin: http://evil.example"}).status, 403) << target;
    }
    const HttpReply allowed = request(port(), onePicture, {"Origin: https://viewer.example"});
    EXPECT_EQ(allowed.status, 200);
    EXPECT_EQ(allowed.header("access-control-allow-origin"), "https://viewer.example");
}

TEST_F(HttpTest, AUsedPortIsAnErrorThatSaysSo) {
    start();
    ServerOptions same = options;
    same.port = port();
    const auto second = ScancastServer::create(same, painter.open());
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().message.find(std::to_string(port())), std::string::npos);
    EXPECT_NE(second.error().message.find("--port 0"), std::string::npos);
}

}  // namespace
}  // namespace scancast::test
