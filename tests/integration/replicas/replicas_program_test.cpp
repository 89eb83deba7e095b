// The programs as replicas: two of them with the same folder of clouds and the same key, on the CPU device.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/program_fixture.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ReplicasProgramTest : public ProgramTest {
  protected:
    struct Replica {
        std::unique_ptr<Process> process;
        std::uint16_t port = 0;
    };

    void SetUp() override {
        generate("town.las");
        ASSERT_EQ(run({"scancast", "ingest", file("town.las"), "-o", file("town.scan")}), 0) << lastError;
        fs::create_directory(file("clouds"));
        fs::copy_file(file("town.scan"), file("clouds/town.scan"));
        std::ofstream(folder / "key") << "sessions Hn5tY8kP2wQ7zX4cV1bM9sD6fG3jL0rA\n";
        fs::permissions(folder / "key", fs::perms::owner_read | fs::perms::owner_write);
    }
    Replica replica(const std::string& name, const std::vector<std::string>& more = {}) {
        const fs::path own = folder / name;
        fs::create_directories(own);
        std::vector<std::string> arguments{"scancast",  "serve",          "--port",
                                           "0",         "--backend",      "cpu",
                                           "--catalog", file("clouds"),   "--session-key-file",
                                           file("key"), "--memory-limit", "512M"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        Replica made{std::make_unique<Process>(own, arguments)};
        const bool isReady = waitUntil([&] {
            const std::string out = made.process->out();
            const auto at = out.find("http://127.0.0.1:");
            if (at == std::string::npos || out.find('\n', at) == std::string::npos) return false;
            made.port = std::uint16_t(std::stoi(out.substr(at + 17)));
            return request(made.port, "/readyz").status == 200;
        });
        EXPECT_TRUE(isReady) << made.process->err();
        return made;
    }
    static bool waitUntil(const std::function<bool()>& condition) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (!condition()) {
            if (std::chrono::steady_clock::now() > end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return true;
    }
    static json next(RawWebSocket& socket, const std::string& type) {
        while (true) {
            const WsMessage message = socket.receiveKind(WsMessage::Kind::Text);
            if (message.kind != WsMessage::Kind::Text) return {};
            json text = json::parse(message.payload);
            if (text["type"] == type) return text;
        }
    }
};

const char* const picture = "/api/v1/clouds/town/snapshot.jpg?width=160&height=120";

TEST_F(ReplicasProgramTest, OneIsKilledAndItsSessionGoesOnWithTheSameBytes) {
    const Replica first = replica("first"), second = replica("second");
    const HttpReply here = request(first.port, picture), there = request(second.port, picture);
    EXPECT_EQ(here.status, 200);
    EXPECT_EQ(here.header("etag"), there.header("etag"));
    EXPECT_EQ(here.body, there.body);
    RawWebSocket stream(first.port);
    stream.text(R"({"type":"hello","width":160,"height":120})");
    const json welcome = next(stream, "welcome");
    stream.text(R"({"type":"view","seq":7,"camera":{"eye":[3,2,1]},"method":"cone"})");
    std::string before;
    FrameHeader last;
    receiveFinal(stream, 7, before, &last);
    first.process->signal(SIGKILL);
    EXPECT_EQ(stream.receiveKind(WsMessage::Kind::Binary).kind, WsMessage::Kind::Gone);
    RawWebSocket again(second.port);
    json view = welcome["view"];
    view.update({{"method", "cone"}});
    view["camera"]["eye"] = {3, 2, 1};
    again.text(json{{"type", "hello"},
                    {"cloud", "town"},
                    {"resume", welcome["resume"]},
                    {"view", view},
                    {"seq", 7},
                    {"frame", last.frameId}}
                   .dump());
    const json resumed = next(again, "welcome");
    EXPECT_EQ(resumed["resumed"], true);
    EXPECT_EQ(resumed["session"], welcome["session"]);
    std::string after;
    receiveFinal(again, 7, after);
    EXPECT_EQ(after, before);
}

TEST_F(ReplicasProgramTest, SigtermLetsClientsGoFirst) {
    const Replica leaving = replica("leaving", {"--drain-seconds", "50"});
    RawWebSocket stream(leaving.port);
    stream.text(R"({"type":"hello","width":160,"height":120})");
    next(stream, "welcome");
    std::string shown;
    receiveFinal(stream, 0, shown);
    leaving.process->signal(SIGTERM);
    EXPECT_EQ(next(stream, "drain")["withinMilliseconds"], 50'000);
    leaving.process->signal(SIGHUP);
    EXPECT_TRUE(waitUntil([&] { return leaving.process->err().find("Reloaded: ") != std::string::npos; }));
    EXPECT_EQ(request(leaving.port, "/readyz").status, 503);
    EXPECT_THAT(request(leaving.port, "/metrics").body,
                AllOf(HasSubstr("\nscancast_draining 1\n"), HasSubstr("\nscancast_sessions 1\n"),
                      HasSubstr("\nscancast_render_saturation ")));
    stream.text(R"({"type":"view","seq":8,"camera":{"eye":[3,2,1]}})");
    receiveFinal(stream, 8, shown);
    EXPECT_FALSE(shown.empty()) << "it draws on";
    stream.socket().abort();
    EXPECT_EQ(leaving.process->wait(std::chrono::seconds(30)), 0) << "the last one has gone";
}

TEST_F(ReplicasProgramTest, ASecondSignalEndsTheWaiting) {
    const Replica leaving = replica("leaving", {"--drain-seconds", "50"});
    RawWebSocket stream(leaving.port);
    stream.text(R"({"type":"hello"})");
    next(stream, "welcome");
    leaving.process->signal(SIGTERM);
    EXPECT_TRUE(next(stream, "drain").is_object());
    leaving.process->signal(SIGTERM);
    EXPECT_EQ(next(stream, "bye")["code"], 1001);
    stream.socket().abort();
    EXPECT_EQ(leaving.process->wait(std::chrono::seconds(30)), 0);
    EXPECT_THAT(leaving.process->err(), HasSubstr("streams that have not gone in time: 1"));
}

TEST_F(ReplicasProgramTest, CloudsAppearAndVanish) {
    const Replica server = replica("server");
    const auto list = [&] { return request(server.port, "/api/v1/clouds").body; };
    const std::string whole = [&] {
        std::ifstream in(file("town.scan"), std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    }();
    std::ofstream(folder / "clouds/half.scan", std::ios::binary) << whole.substr(0, whole.size() / 2);
    fs::copy_file(file("town.scan"), file("clouds/.church.scan.part"));
    fs::rename(file("clouds/.church.scan.part"), file("clouds/church.scan"));
    EXPECT_TRUE(waitUntil([&] {
        return request(server.port, "/api/v1/clouds/church/snapshot.jpg?width=32&height=16").status == 200;
    })) << server.process->err();
    EXPECT_THAT(list(), Not(HasSubstr("half")));
    EXPECT_THAT(server.process->err(), HasSubstr("half.scan is not served until it is whole"));
    RawWebSocket stream(server.port);
    stream.text(R"({"type":"hello","cloud":"church"})");
    next(stream, "welcome");
    fs::remove(file("clouds/church.scan"));
    EXPECT_EQ(next(stream, "problem")["problem"]["status"], 404);
    EXPECT_EQ(next(stream, "bye")["code"], 1001);
    EXPECT_THAT(list(), AllOf(HasSubstr("\"town\""), Not(HasSubstr("church"))));
}

}  // namespace
}  // namespace scancast::test
