// Pictures over plain HTTP, sessions driven by POST, and one session that follows another: over real sockets.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

/// A client that reads parts; what it has read and not used yet is kept.
class MjpegClient {
  public:
    struct Part {
        std::string kind;
        std::uint64_t seq = 0;
        std::string picture;
        bool damaged = false, away = false;
    };

    MjpegClient(std::uint16_t port, const std::string& query, const std::string& cloud = "one",
                int receiveBuffer = 0)
        : socket(port, receiveBuffer) {
        socket.send("GET /api/v1/clouds/" + cloud + "/stream.mjpg" + query +
                    " HTTP/1.1\r\nHost: localhost\r\n\r\n");
        head = readReply(socket);
        buffer_ = head.status == 200 ? head.body : "";
    }
    std::string session() const { return head.header("scancast-session"); }

    /// The next part; empty kind when none comes.
    Part part(std::chrono::milliseconds patience = netPatience) {
        const auto start = find("--scancast\r\n", 0, patience);
        const auto headEnd = find("\r\n\r\n", start, patience);
        if (start == std::string::npos || headEnd == std::string::npos) return {};
        const auto length = field("Content-Length: ", start);
        while (buffer_.size() < headEnd + 4 + length)
            if (!more(patience)) return {};
        Part part{"", field("Scancast-Seq: ", start), buffer_.substr(headEnd + 4, length)};
        part.damaged =
            buffer_.substr(start, headEnd + 2 - start).find("Scancast-Damaged: yes\r\n") != std::string::npos;
        part.away =
            buffer_.substr(start, headEnd + 2 - start).find("Scancast-Away: yes\r\n") != std::string::npos;
        const auto kind = buffer_.find("Scancast-Kind: ", start) + 15;
        part.kind = buffer_.substr(kind, buffer_.find("\r\n", kind) - kind);
        buffer_.erase(0, headEnd + 4 + length);
        return part;
    }
    /// The final still of that view.
    Part finalPart(std::uint64_t seq) {
        while (true) {
            Part next = part();
            if (next.kind.empty() || (next.kind == "final" && next.seq == seq)) return next;
        }
    }
    /// Nothing but the end comes, in time.
    bool ends() {
        while (more(netPatience)) continue;
        return socket.atEnd();
    }

    RawSocket socket;
    HttpReply head;

  private:
    bool more(std::chrono::milliseconds patience) {
        const std::string bytes = socket.receive(65536, patience);
        buffer_ += bytes;
        return !bytes.empty();
    }
    std::size_t find(const std::string& text, std::size_t from, std::chrono::milliseconds patience) {
        if (from == std::string::npos) return from;
        while (true) {
            const auto at = buffer_.find(text, from);
            if (at != std::string::npos || !more(patience)) return at;
        }
    }
    std::size_t field(const std::string& name, std::size_t from) const {
        return std::stoul(buffer_.substr(buffer_.find(name, from) + name.size(), 20));
    }

    std::string buffer_;
};

class MjpegTest : public ServerTest {
  protected:
    HttpReply drive(const std::string& session, const nlohmann::json& view) {
        return post(port(), "/api/v1/sessions/" + session + "/view", view.dump(), {sendsJson});
    }
};

TEST_F(MjpegTest, PlainHttpGetsTheFinalStillAndThenSilence) {
    start();
    MjpegClient client(port(), "?width=48&height=32&eye=77,-50,30&target=5,5,0&fps=10");
    EXPECT_EQ(client.head.status, 200);
    EXPECT_EQ(client.head.header("content-type"), "multipart/x-mixed-replace; boundary=scancast");
    EXPECT_EQ(client.head.header("cache-control"), "no-store");
    EXPECT_EQ(client.head.header("scancast-method"), request(port(), onePicture).header("scancast-method"));
    EXPECT_EQ(client.head.header("scancast-method-reason"),
              request(port(), onePicture).header("scancast-method-reason"));
    EXPECT_NE(client.head.header("scancast-method-reason"), "");
    const auto still = client.finalPart(0);
    EXPECT_EQ(still.picture,
              request(port(), "/api/v1/clouds/one/snapshot.jpg?width=48&height=32&eye=77,-50,30&target=5,5,0")
                  .body);
    EXPECT_EQ(client.part(std::chrono::milliseconds(300)).kind, "");
    EXPECT_EQ(metric("scancast_sessions"), "scancast_sessions 1");
}

TEST_F(MjpegTest, APartSaysThatItLacksSomething) {
    start();
    MjpegClient client(port(), "?width=48&height=32");
    EXPECT_FALSE(client.finalPart(0).damaged);
    painter.damage(2);
    ASSERT_EQ(drive(client.session(), {{"seq", 3}, {"camera", {{"eye", {9, -50, 30}}}}}).status, 200);
    const auto damaged = client.finalPart(3);
    EXPECT_TRUE(damaged.damaged && !damaged.away);
    painter.damage(0);
    painter.setAway(true);
    ASSERT_EQ(drive(client.session(), {{"seq", 4}, {"camera", {{"eye", {9, -51, 30}}}}}).status, 200);
    const auto coarser = client.finalPart(4);
    EXPECT_TRUE(coarser.away && !coarser.damaged);
}

TEST_F(MjpegTest, AViewMayStandStillForLongerThanAWriteMayTake) {
    options.limits.writeTimeout = std::chrono::seconds(1);
    start();
    MjpegClient client(port(), "?width=48&height=32");
    ASSERT_EQ(client.finalPart(0).kind, "final");
    EXPECT_EQ(client.part(std::chrono::milliseconds(2000)).kind, "");
    EXPECT_EQ(drive(client.session(), {{"seq", 3}, {"camera", {{"eye", {9, -50, 30}}}}}).status, 200);
    EXPECT_EQ(client.finalPart(3).kind, "final");
}

TEST_F(MjpegTest, CurlDrivesItByThatSessionsAddress) {
    start();
    MjpegClient client(port(), "?width=48&height=32");
    ASSERT_EQ(client.finalPart(0).kind, "final");
    const HttpReply driven = drive(client.session(), {{"seq", 5}, {"camera", {{"eye", {9, -50, 30}}}}});
    ASSERT_EQ(driven.status, 200) << driven.body;
    const auto shown = parseJson(driven.body).value();
    EXPECT_EQ(shown["seq"], 5);
    EXPECT_EQ(shown["view"]["camera"]["eye"][0], 9);
    EXPECT_EQ(shown["view"]["width"], 48);
    EXPECT_EQ(client.finalPart(5).kind, "final");
    // As a `view` message it may switch clouds; without a seq the one before stays.
    EXPECT_EQ(parseJson(drive(client.session(), {{"type", "view"}, {"cloud", "two"}}).body).value()["seq"],
              5);
    EXPECT_EQ(client.finalPart(5).kind, "final");
    EXPECT_EQ(painter.begun().back().cloud, two.get());
}

TEST_F(MjpegTest, ARefusedChangeIsAProblemAndChangesNothing) {
    start();
    MjpegClient client(port(), "?width=48&height=32");
    ASSERT_EQ(client.finalPart(0).kind, "final");
    const std::tuple<nlohmann::json, int, const char*> wrong[] = {
        {{{"camera", {{"fvo", 3}}}}, 400, "camera.fvo"},
        {{{"type", "ack"}, {"frame", 1}}, 400, "type"},
        {{{"seq", -1}}, 400, "seq"},
        {{{"cloud", "three"}}, 404, "cloud"},
        {{{"follow", "nobody"}}, 404, "follow"},
        {{{"width", 16384}, {"height", 16384}}, 413, "width"},
        {{{"camera", {{"eye", {5, 5, 0}}, {"target", {5, 5, 0}}}}}, 422, ""},
        {nlohmann::json::array(), 400, ""},
    };
    for (const auto& [view, status, field] : wrong) {
        const HttpReply reply = drive(client.session(), view);
        EXPECT_EQ(reply.status, status) << view << reply.body;
        EXPECT_EQ(reply.header("content-type"), "application/problem+json");
        if (*field != '\0') {
            EXPECT_EQ(parseJson(reply.body).value()["errors"][0]["parameter"], field);
        }
    }
    EXPECT_EQ(client.part(std::chrono::milliseconds(200)).kind, "");
    EXPECT_EQ(drive("nobody", {{"width", 10}}).status, 404);
    EXPECT_EQ(post(port(), "/api/v1/sessions/" + client.session() + "/view", "{}", {}).status, 415);
    EXPECT_EQ(request(port(), "/api/v1/sessions/" + client.session() + "/view").status, 405);
}

TEST_F(MjpegTest, RefusalsComeBeforeAnyPicture) {
    options.limits.maxSessions = 1;
    start();
    MjpegClient client(port(), "?width=48&height=32");
    ASSERT_EQ(client.finalPart(0).kind, "final");
    const std::tuple<const char*, const char*, int> wrong[] = {
        {"three", "", 404},
        {"one", "?fvo=3", 400},
        {"one", "?fps=0", 400},
        {"one", "?fps=fast", 400},
        {"one", "?width=16384&height=16384", 413},
        {"one", "?eye=1,1,1&target=1,1,1", 422},
        {"one", "?session=x&method=cone", 400},
        {"one", "", 503},
    };
    for (const auto& [cloud, query, status] : wrong) {
        const MjpegClient refused(port(), query, cloud);
        EXPECT_EQ(refused.head.status, status) << query;
        EXPECT_EQ(parseJson(refused.head.body).value()["status"], status);
        if (status == 503) {
            EXPECT_NE(refused.head.header("retry-after"), "");
        }
    }
    EXPECT_EQ(request(port(), "/api/v1/clouds/one/stream.mjpg", {"Accept: text/html"}).status, 406);
    EXPECT_EQ(request(port(), "/api/v1/clouds/one/stream.mjpg", {}, "HEAD").status, 200);
    EXPECT_EQ(request(port(), "/api/v1/clouds/one/stream.mjpg?fvo=1", {}, "HEAD").status, 400);
    EXPECT_EQ(StreamClient(port()).closeCode(), 1013) << "it counts as a session like any other";
    client.socket.abort();
    EXPECT_TRUE(eventually([&] { return metric("scancast_sessions") == "scancast_sessions 0"; }));
}

// What has not been written does not count as seen: of a hundred views few are drawn while nobody reads.
TEST_F(MjpegTest, ASlowReaderGetsFewerPicturesAndNoOldOnes) {
    start();
    MjpegClient client(port(), "?width=1600&height=1200&quality=100", "one", 4096);
    ASSERT_EQ(client.finalPart(0).kind, "final");
    const auto before = painter.begun().size();
    for (int seq = 1; seq <= 100; ++seq)
        ASSERT_EQ(drive(client.session(), {{"seq", seq}, {"camera", {{"eye", {seq, -50, 30}}}}}).status, 200);
    // What the sockets' buffers hold, and one; not a hundred.
    EXPECT_LT(painter.begun().size() - before, 40U);
    std::uint64_t last = 0;
    while (true) {
        const auto part = client.part();
        ASSERT_NE(part.kind, "");
        EXPECT_GE(part.seq, last);
        last = part.seq;
        if (part.kind == "final" && part.seq == 100) break;
    }
}

TEST_F(MjpegTest, AShutdownEndsIt) {
    start();
    MjpegClient client(port(), "?width=48&height=32");
    ASSERT_EQ(client.finalPart(0).kind, "final");
    server->shutDown();
    EXPECT_TRUE(client.ends());
    EXPECT_TRUE(server->waitForClients(netPatience));
}

TEST_F(MjpegTest, ItFollowsASessionUntilThatLeaves) {
    start();
    auto leader = std::make_unique<StreamClient>(port());
    const auto welcome = leader->greet({{"cloud", "two"}});
    leader->view(1, 44);
    ASSERT_TRUE(leader->finalFrame(1));
    MjpegClient follower(port(), "?width=80&height=40&session=" + welcome["session"].get<std::string>());
    ASSERT_EQ(follower.head.status, 200);
    const std::string same = "/api/v1/clouds/two/snapshot.jpg?width=80&height=40&target=5,5,0&eye=";
    EXPECT_EQ(follower.finalPart(0).picture, request(port(), same + "44,-50,30").body);
    leader->view(2, 99);
    const std::string moved = request(port(), same + "99,-50,30").body;
    auto part = follower.finalPart(0);
    while (part.kind == "final" && part.picture != moved) part = follower.finalPart(0);
    EXPECT_EQ(part.picture, moved);
    leader.reset();
    EXPECT_TRUE(follower.ends());
}

TEST_F(MjpegTest, AWebSocketFollowsAndIsToldOfTheEnd) {
    start();
    auto leader = std::make_unique<StreamClient>(port());
    const std::string id = leader->greet({{"cloud", "two"}})["session"];
    StreamClient follower(port());
    const auto welcome = follower.greet({{"follow", id}, {"width", 80}, {"height", 40}});
    EXPECT_EQ(welcome["cloud"], "two");
    EXPECT_EQ(welcome["view"]["width"], 80);
    ASSERT_EQ(drive(id, {{"camera", {{"eye", {33, -50, 30}}, {"target", {5, 5, 0}}}}}).status, 200);
    const std::string moved =
        request(port(), "/api/v1/clouds/two/snapshot.jpg?width=80&height=40&target=5,5,0&eye=33,-50,30").body;
    auto frame = follower.finalFrame(0);
    while (frame && std::string(frame->picture.begin(), frame->picture.end()) != moved)
        frame = follower.finalFrame(0);
    EXPECT_TRUE(frame) << "the leader's view, in the follower's size";
    leader->socket.socket().abort();
    const auto problem = follower.control("problem");
    EXPECT_EQ(problem["problem"]["status"], 404);
    EXPECT_EQ(problem["problem"]["errors"][0]["parameter"], "follow");
    follower.view(1, 10);
    EXPECT_TRUE(follower.finalFrame(1)) << "it has a view of its own again";
}

}  // namespace
}  // namespace scancast::test
