// The programs as people run them: generate a scan, serve it, and ask for it with curl's means and with the
// client.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "protocol/frame_header.hpp"
#include "renderer/image/encode.hpp"
#include "tests/integration/raw_client.hpp"
#include "tests/support/test_data.hpp"

namespace scancast::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A program of ours, its output in files; killed when the test leaves it behind.
class Process {
  public:
    Process(const fs::path& folder, const std::vector<std::string>& arguments)
        : out_(folder / "stdout.txt"), err_(folder / "stderr.txt") {
        std::vector<std::string> words = arguments;
        words[0] = std::string(SCANCAST_BIN_DIR) + "/" + words[0];
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        const std::string out = out_.string();
        const std::string err = err_.string();
        pid_ = fork();
        if (pid_ == 0) {
            dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), 1);
            dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), 2);
            execv(argv[0], argv.data());
            _exit(127);
        }
    }
    ~Process() {
        if (pid_ <= 0) return;
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    void signal(int number) const { kill(pid_, number); }
    /// Its exit code; -1 when it does not end in time or is killed by a signal.
    int wait(std::chrono::seconds patience = std::chrono::seconds(60)) {
        const auto end = std::chrono::steady_clock::now() + patience;
        int status = 0;
        while (waitpid(pid_, &status, WNOHANG) == 0) {
            if (std::chrono::steady_clock::now() > end) return -1;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        pid_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    std::string out() const { return contents(out_); }
    std::string err() const { return contents(err_); }

  private:
    fs::path out_, err_;
    pid_t pid_ = -1;
};

class ProgramTest : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        folder = fs::path(::testing::TempDir()) / (std::string("scancast_program_") + info->name());
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }

    /// Runs a program to its end.
    int run(const std::vector<std::string>& arguments, std::string* out = nullptr) {
        Process process(folder, arguments);
        const int code = process.wait();
        if (out != nullptr) *out = process.out();
        lastError = process.err();
        return code;
    }
    std::string file(const std::string& name) const { return (folder / name).string(); }
    void generate(const std::string& name, const std::string& scene = "sphere") {
        ASSERT_EQ(run({"scancast", "generate", scene, "--points", "20000", "-o", file(name)}), 0)
            << lastError;
    }
    /// Starts a server and waits until it is ready; its files are in a folder of their own.
    std::unique_ptr<Process> serve(std::vector<std::string> arguments) {
        fs::create_directories(folder / "server");
        arguments.insert(arguments.begin(), {"scancast", "serve", "--port", "0"});
        auto process = std::make_unique<Process>(folder / "server", arguments);
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (std::chrono::steady_clock::now() < end) {
            const std::string out = process->out();
            const auto at = out.find("http://127.0.0.1:");
            if (at != std::string::npos && out.find('\n', at) != std::string::npos) {
                url = out.substr(at, out.find('\n', at) - at);
                port = std::uint16_t(std::stoi(url.substr(17)));
                if (request(port, "/readyz").status == 200) return process;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        ADD_FAILURE() << "the server never became ready: " << process->out() << process->err();
        return process;
    }

    fs::path folder;
    std::string url, lastError;
    std::uint16_t port = 0;
};

TEST_F(ProgramTest, ServeSnapshotInfoAndOrbit) {
    generate("ball.las");
    const auto server = serve({file("ball.las")});
    EXPECT_THAT(server->out(), HasSubstr("Open http://127.0.0.1:"));

    std::string info;
    ASSERT_EQ(run({"scancast-client", "info", url}, &info), 0) << lastError;
    EXPECT_THAT(info, HasSubstr("ball"));

    ASSERT_EQ(
        run({"scancast-client", "snapshot", url, "--width", "200", "--height", "100", "-o", file("a.jpg")}),
        0)
        << lastError;
    // Oracle: two clients that share no code get the same bytes.
    const HttpReply same = request(port, "/api/v1/clouds/ball/snapshot.jpg?width=200&height=100");
    EXPECT_EQ(contents(folder / "a.jpg"), same.body);
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
        pictures.insert(contents(entry.path()));
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
        EXPECT_EQ(contents(folder / "r.jpg"), served) << threads << " threads";
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
    FrameHeader header;
    std::string picture;
    while (!(header.final && header.seq == 20)) {
        const WsMessage message = stream.receiveKind(WsMessage::Kind::Binary);
        ASSERT_EQ(message.kind, WsMessage::Kind::Binary) << "no final still came";
        const auto parsed = parseFrame(
            {reinterpret_cast<const std::uint8_t*>(message.payload.data()), message.payload.size()});
        ASSERT_TRUE(parsed) << parsed.error().message;
        header = parsed->header;
        picture.assign(parsed->picture.begin(), parsed->picture.end());
        stream.text(R"({"type":"ack","frame":)" + std::to_string(header.frameId) + "}");
    }
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
    EXPECT_THAT(out, HasSubstr("Example: scancast serve"));
    EXPECT_EQ(run({"scancast"}), 1);
}

}  // namespace
}  // namespace scancast::test
