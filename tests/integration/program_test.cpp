// The programs as people run them: generate a scan, serve it, and ask for it with curl's means and with the
// client.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "protocol/frame_header.hpp"
#include "renderer/image/encode.hpp"
#include "tests/integration/program_fixture.hpp"
#include "tests/support/serving/notify_socket.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/test_data.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;

TEST_F(ProgramTest, ServeSnapshotInfoAndOrbit) {
    generate("ball.las");
    const auto server = serve({file("ball.las")});
    EXPECT_THAT(server->out(), HasSubstr("Open http://127.0.0.1:"));

    std::string info;
    ASSERT_EQ(run({"scancast-client", "info", url}, &info), 0) << lastError;
    EXPECT_THAT(info, HasSubstr("ball"));

    std::string said;
    ASSERT_EQ(
        run({"scancast-client", "snapshot", url, "--width", "200", "--height", "100", "-o", file("a.jpg")},
            &said),
        0)
        << lastError;
    EXPECT_THAT(said, HasSubstr(", drawn as "));
    // Oracle: two clients that share no code get the same bytes.
    const HttpReply same = request(port, "/api/v1/clouds/ball/snapshot.jpg?width=200&height=100");
    EXPECT_EQ(contentOf(folder / "a.jpg"), same.body);
    const auto frame =
        decodeJpeg({reinterpret_cast<const std::uint8_t*>(same.body.data()), same.body.size()});
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->width, 200);
    EXPECT_EQ(frame->height, 100);

    ASSERT_EQ(run({"scancast-client", "orbit", url, "--frames", "6", "--width", "160", "--height", "120",
                   "-o", file("orbit")}),
              0)
        << lastError;
    std::set<std::string> pictures;
    for (const auto& entry : fs::directory_iterator(folder / "orbit"))
        pictures.insert(contentOf(entry.path()));
    EXPECT_EQ(pictures.size(), 6U) << "each step must be another picture";
}

// Byte-identical pictures are a promise: whoever draws, on however many threads.
TEST_F(ProgramTest, RenderAndServeGiveTheSameBytesOnAnyNumberOfThreads) {
    generate("ball.ply");
    const auto server = serve({file("ball.ply"), "--backend", "cpu", "--threads", "2"});
    const std::string served =
        request(port, "/api/v1/clouds/ball/snapshot.jpg?width=320&height=240&eye=3,2,1&target=0,0,0").body;
    ASSERT_FALSE(served.empty());
    for (const char* threads : {"1", "2"}) {
        ASSERT_EQ(
            run({"scancast", "render", file("ball.ply"), "--backend", "cpu", "--threads", threads, "--width",
                 "320", "--height", "240", "--eye", "3,2,1", "--target", "0,0,0", "-o", file("r.jpg")}),
            0)
            << lastError;
        EXPECT_EQ(contentOf(folder / "r.jpg"), served) << threads << " threads";
    }
}

// With the real device: anti-aliased, in passes, interrupted by views before it, and still the snapshot's
// bytes.
TEST_F(ProgramTest, TheFinalStillOfAStreamIsTheSnapshot) {
    generate("ball.las");
    const auto server = serve({file("ball.las")});
    RawWebSocket stream(port);
    stream.text(R"({"type":"hello","width":240,"height":160})");
    for (int seq = 1; seq <= 20; ++seq) {
        stream.text(R"({"type":"view","method":"cone","camera":{"target":[0,0,0],"eye":[3,2,)" +
                    std::to_string(seq) + R"(]},"seq":)" + std::to_string(seq) + "}");
    }
    std::string picture;
    ASSERT_NO_FATAL_FAILURE(receiveFinal(stream, 20, picture));
    EXPECT_EQ(picture, request(port,
                               "/api/v1/clouds/ball/snapshot.jpg?width=240&height=160&method=cone"
                               "&eye=3,2,20&target=0,0,0")
                           .body);
}

TEST_F(ProgramTest, ABadFileIsNamedAndTheOthersAreServed) {
    generate("good.las");
    std::ofstream(folder / "bad.las") << "not a scan";
    const auto server = serve({file("bad.las"), file("good.las"), file("missing.ply")});
    EXPECT_EQ(request(port, "/api/v1/clouds/good").status, 200);
    EXPECT_EQ(request(port, "/api/v1/clouds/bad").status, 404);
    EXPECT_THAT(server->err(), HasSubstr("bad.las"));
    EXPECT_THAT(server->err(), HasSubstr("missing.ply"));
}

// As in the README, with a named pipe between the two.
TEST_F(ProgramTest, FramesOfALiveSourceAreServed) {
    const std::string fifo = file("frames.fifo");
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    const auto frames = [&](const char* count) {
        return std::vector<std::string>{"scancast", "generate", "statue", "--points", "5000", "--frames",
                                        count,      "--rate",   "20",     "-o",       fifo};
    };
    fs::create_directories(folder / "camera");
    Process camera(folder / "camera", frames("5"));
    const auto server = serve({"--backend", "cpu", "--live", "depth=" + fifo});
    EXPECT_EQ(camera.wait(), 0) << camera.err();
    EXPECT_THAT(camera.err(), HasSubstr("5 frames of 5000 points"));
    const auto live = [&] {
        return nlohmann::json::parse(request(port, "/api/v1/clouds/depth").body)["live"];
    };
    const auto becomes = [&](const char* state) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        while (live()["state"] != state && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        return live()["state"] == state;
    };
    ASSERT_TRUE(becomes("ended"));
    EXPECT_EQ(live()["shown"].get<int>() + live()["skipped"].get<int>(), 5);
    const char* picture = "/api/v1/clouds/depth/snapshot.jpg?width=64&height=48&method=voronoi";
    const HttpReply last = request(port, picture);
    ASSERT_EQ(last.status, 200) << last.body;
    EXPECT_EQ(last.header("cache-control"), "no-store");
    // Another writer goes on, and one that writes nonsense is told of; what it was stays to be seen.
    EXPECT_EQ(run(frames("2")), 0) << lastError;
    std::ofstream(fifo) << std::string(500, 'x');
    ASSERT_TRUE(becomes("broken"));
    EXPECT_NE(live()["error"].get<std::string>().find("point stream"), std::string::npos);
    const HttpReply later = request(port, picture);
    EXPECT_EQ(later.status, 200);
    EXPECT_NE(later.header("etag"), "");
    server->signal(SIGTERM);
    EXPECT_EQ(server->wait(), 0) << server->err();
    EXPECT_NE(server->err().find("depth: its frames have ended"), std::string::npos) << server->err();
}

TEST_F(ProgramTest, WithNothingLeftToServeItFails) {
    std::ofstream(folder / "bad.las") << "not a scan";
    EXPECT_EQ(run({"scancast", "serve", "--port", "0", file("bad.las")}), 1);
    EXPECT_THAT(lastError, HasSubstr("bad.las"));
    EXPECT_EQ(run({"scancast", "serve"}), 1);
    EXPECT_THAT(lastError, HasSubstr("scancast generate"));
    EXPECT_EQ(run({"scancast", "serve", file("bad.las"), "--host", "0.0.0.0"}), 1);
    EXPECT_THAT(lastError, HasSubstr("--insecure"));
}

TEST_F(ProgramTest, TwoFilesOfOneNameGetTwoIds) {
    generate("ball.las");
    fs::create_directories(folder / "other");
    fs::copy_file(folder / "ball.las", folder / "other" / "ball.las");
    const auto server = serve({file("ball.las"), file("other/ball.las")});
    EXPECT_EQ(request(port, "/api/v1/clouds/ball").status, 200);
    EXPECT_EQ(request(port, "/api/v1/clouds/ball-2").status, 200);
}

TEST_F(ProgramTest, SignalsEndItGracefully) {
    generate("ball.las");
    for (int signal : {SIGTERM, SIGINT}) {
        const auto server = serve({file("ball.las")});
        RawWebSocket stream(port);
        stream.text(R"({"type":"hello"})");
        EXPECT_EQ(stream.receiveKind(WsMessage::Kind::Binary).kind, WsMessage::Kind::Binary);
        server->signal(signal);
        EXPECT_EQ(stream.receiveKind(WsMessage::Kind::Close).closeCode(), 1001);
        stream.socket().abort();
        EXPECT_EQ(server->wait(std::chrono::seconds(20)), 0);
    }
}

TEST_F(ProgramTest, ItsServiceManagerHearsHowItIsDoing) {
    generate("ball.las");
    const NotifySocket manager(file("notify"));
    const auto server = serve({file("ball.las")}, [&manager] {
        ::setenv("NOTIFY_SOCKET", manager.name().c_str(), 1);
        ::setenv("WATCHDOG_USEC", "400000", 1);
    });
    EXPECT_TRUE(manager.until("READY=1\n"));
    EXPECT_TRUE(manager.until("1 of 1 clouds ready"));
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(manager.until("WATCHDOG=1\n")) << i;
    server->signal(SIGTERM);
    EXPECT_TRUE(manager.until("STOPPING=1\n"));
    EXPECT_EQ(server->wait(std::chrono::seconds(20)), 0);
}

TEST_F(ProgramTest, AClientThatNeverLeavesDoesNotHoldTheServer) {
    generate("ball.las");
    const auto server = serve({file("ball.las")});
    RawWebSocket deaf(port);  // does not read, does not answer the close
    server->signal(SIGTERM);
    EXPECT_EQ(server->wait(std::chrono::seconds(20)), 0);
}

TEST_F(ProgramTest, JsonLogLinesAreJson) {
    generate("ball.las");
    const auto server = serve({file("ball.las"), "--log-format", "json"});
    server->signal(SIGTERM);
    ASSERT_EQ(server->wait(), 0);
    std::istringstream lines(server->err());
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
        const auto json = nlohmann::json::parse(line, nullptr, false);
        ASSERT_FALSE(json.is_discarded()) << line;
        EXPECT_TRUE(json.contains("time") && json.contains("level") && json.contains("message")) << line;
    }
    EXPECT_GE(count, 2);
}

TEST_F(ProgramTest, ARealColouredScan) {
    REQUIRE_TEST_DATA("ply/guanyin-statue.ply");
    const auto server = serve({testData("ply/guanyin-statue.ply").string()});
    const HttpReply picture =
        request(port, "/api/v1/clouds/guanyin-statue/snapshot.png?width=320&height=240");
    ASSERT_EQ(picture.status, 200);
    const auto frame =
        decodePng({reinterpret_cast<const std::uint8_t*>(picture.body.data()), picture.body.size()});
    ASSERT_TRUE(frame);
    // The scan is coloured, and the default view shows it: many colours that the background has not.
    std::set<std::uint32_t> colors;
    for (std::size_t i = 0; i < frame->rgba.size(); i += 4) {
        colors.insert(std::uint32_t(frame->rgba[i]) << 16 | std::uint32_t(frame->rgba[i + 1]) << 8 |
                      frame->rgba[i + 2]);
    }
    EXPECT_GT(colors.size(), 1000U);
}

TEST_F(ProgramTest, VersionBackendsAndHelp) {
    std::string out;
    EXPECT_EQ(run({"scancast", "--version"}, &out), 0);
    EXPECT_THAT(out, HasSubstr("scancast 0."));
    EXPECT_EQ(run({"scancast", "--list-backends"}, &out), 0);
    EXPECT_THAT(out, HasSubstr("cpu"));
    EXPECT_EQ(run({"scancast", "serve", "--help"}, &out), 0);
    EXPECT_THAT(out, HasSubstr("scancast serve town.las"));
    EXPECT_EQ(run({"scancast-client", "--version"}, &out), 0);
    EXPECT_THAT(out, HasSubstr("scancast-client 0."));
}

// Large pictures where there is no memory for them, whatever the limits say: each is answered, with a picture or with what is missing,
// and the server lives on.
TEST_F(ProgramTest, AServerWithLittleMemoryRefusesWhatDoesNotFitAndLivesOn) {
    if (test::sanitized)
        GTEST_SKIP()
            << "sanitizers need more address space than this test leaves: it runs in the other builds only";
    generate("ball.las");
    const auto server = serve({file("ball.las"), "--backend", "cpu", "--threads", "2", "--max-pixels",
                               "268435456", "--memory-limit", "8G", "--transient-limit", "6G"},
                              [] {
                                  const rlimit limit{rlim_t(5) << 29, rlim_t(5) << 29};
                                  setrlimit(RLIMIT_AS, &limit);
                              });
    const auto ask = [&](const std::string& name, int width, int height) {
        return request(port, "/api/v1/clouds/ball/" + name + "?samples=1&width=" + std::to_string(width) +
                                 "&height=" + std::to_string(height));
    };
    std::vector<std::thread> crowd;
    for (const char* name : {"snapshot.png", "snapshot.jpg"})
        for (const int side : {10000, 16384})
            crowd.emplace_back([&, name, side] {
                const HttpReply reply = ask(name, side, side);
                EXPECT_TRUE(reply.status == 200 || reply.status == 413)
                    << name << side << ": " << reply.status;
                if (reply.status == 413) {
                    EXPECT_THAT(reply.body, HasSubstr("memory"));
                }
            });
    for (std::thread& one : crowd) one.join();
    const HttpReply refused = ask("snapshot.png", 16384, 16384);  // 2.7 GB
    ASSERT_EQ(refused.status, 413);
    EXPECT_THAT(refused.body, HasSubstr("RLIMIT_AS")) << "the limit is named";
    EXPECT_EQ(ask("snapshot.jpg", 64, 48).status, 200) << server->err();
}

}  // namespace
}  // namespace scancast::test
