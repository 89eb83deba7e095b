// What the outside does to the programs: signals, readers that go away, no room for a file, and names of
// files that lead to something else.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>

#include "tests/integration/program_fixture.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;

/// For Process: files of the program may have this many bytes.
std::function<void()> mostFileBytes(rlim_t bytes) {
    return [bytes] {
        const rlimit most{bytes, bytes};
        setrlimit(RLIMIT_FSIZE, &most);
    };
}

class OutsideProgram : public ProgramTest {
  protected:
    /// What is in the folder, but for the fixture's own files.
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder))
            if (const auto name = entry.path().filename().string();
                name != "stdout.txt" && name != "stderr.txt" && name != "server")
                names.push_back(name);
        std::sort(names.begin(), names.end());
        return names;
    }
    bool answers() const {
        return request(port, "/api/v1/clouds/ball/snapshot.jpg?width=32&height=16").status == 200;
    }
    static bool says(const Process& process, const std::string& words) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (process.err().find(words) == std::string::npos) {
            if (std::chrono::steady_clock::now() > end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return true;
    }
};

TEST_F(OutsideProgram, SignalsToReloadAreSaidAndEndNothing) {
    generate("ball.las");
    const auto server = serve({file("ball.las")});
    for (const int signal : {SIGHUP, SIGUSR1, SIGUSR2}) server->signal(signal);
    EXPECT_TRUE(says(*server, "SIGHUP"));
    EXPECT_TRUE(answers());
    server->signal(SIGTERM);
    EXPECT_EQ(server->wait(std::chrono::seconds(20)), 0);
}

// As with `scancast serve … 2>&1 | head`: the log's reader goes, the server stays.
TEST_F(OutsideProgram, TheServerOutlivesTheReadersOfItsWords) {
    generate("ball.las");
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    const auto server =
        serve({file("ball.las"), "--log-level", "debug"}, [&] { dup2(ends[1], STDERR_FILENO); });
    close(ends[1]);
    close(ends[0]);
    for (const int signal : {SIGHUP, SIGHUP}) {
        server->signal(signal);  // makes it write to its log
        EXPECT_TRUE(answers());
    }
    server->signal(SIGTERM);
    EXPECT_EQ(server->wait(std::chrono::seconds(20)), 0) << "it says that it shuts down, too";
}

TEST_F(OutsideProgram, CommandsOutliveTheReadersOfTheirWords) {
    generate("ball.las");
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    close(ends[0]);
    const auto deaf = [&] { dup2(ends[1], STDERR_FILENO); };
    EXPECT_EQ(run({"scancast", "ingest", file("ball.las"), "-o", file("ball.scan")}, nullptr, deaf), 0);
    EXPECT_EQ(run({"scancast", "generate", "sphere", "--points", "100", "-o", file("b.las")}, nullptr, deaf),
              0);
    EXPECT_EQ(run({"scancast", "info", file("none.las")}, nullptr, deaf), 1);
    // What was asked for is not there: a failure, and no crash.
    EXPECT_EQ(run({"scancast", "info", file("ball.scan")}, nullptr, [&] { dup2(ends[1], STDOUT_FILENO); }),
              1);
    close(ends[1]);
    EXPECT_EQ(files(), (std::vector<std::string>{"b.las", "ball.las", "ball.scan"}));
}

TEST_F(OutsideProgram, FilesThatMayNotGrowAreToldAndLeaveNothing) {
    generate("ball.las");
    const auto refused = [&](const std::vector<std::string>& arguments, const std::string& output) {
        EXPECT_EQ(run(arguments, nullptr, mostFileBytes(4000)), 1) << arguments[1];
        EXPECT_THAT(lastError, HasSubstr(output)) << arguments[1];
        EXPECT_THAT(lastError, HasSubstr("File too large")) << arguments[1];
        EXPECT_EQ(files(), std::vector<std::string>{"ball.las"}) << arguments[1];
    };
    refused({"scancast", "ingest", "-q", file("ball.las"), "-o", file("ball.scan")}, file("ball.scan"));
    refused({"scancast", "generate", "-q", "sphere", "--points", "20000", "-o", file("b.las")},
            file("b.las"));
    refused({"scancast", "render", file("ball.las"), "-o", file("b.png")}, file("b.png"));
    const auto server = serve({file("ball.las")});
    refused({"scancast-client", "snapshot", url, "-o", file("b.jpg")}, file("b.jpg"));
}

// The limit holds for the temporary files of a large scan, too.
TEST_F(OutsideProgram, NoRoomForTemporaryFilesIsToldAndLeavesNothing) {
    ASSERT_EQ(run({"scancast", "generate", "-q", "town", "--points", "100k", "-o", file("a.las")}), 0)
        << lastError;
    fs::create_directories(folder / "server");  // as a place for temporary files that files() passes over
    const auto server = serve({"--cache-dir", file("server"), file("a.las")}, mostFileBytes(100'000));
    EXPECT_TRUE(says(*server, "is kept in memory only: ")) << server->err();
    EXPECT_THAT(server->err(), HasSubstr("File too large"));
    EXPECT_EQ(request(port, "/api/v1/clouds/a").status, 200);
    for (const auto& entry : fs::directory_iterator(folder / "server"))
        EXPECT_EQ(entry.path().string().find("partial"), std::string::npos) << entry.path();
}

TEST_F(OutsideProgram, NamesThatLeadToNoFileKeepNobodyWaiting) {
    generate("ball.las");
    ASSERT_EQ(mkfifo(file("pipe.las").c_str(), 0600), 0);
    fs::create_symlink("pipe.las", folder / "link.scan");
    fs::create_symlink("loop.las", folder / "loop.las");
    const std::pair<std::string, const char*> names[] = {{file("pipe.las"), "is a pipe, not a file"},
                                                         {file("link.scan"), "is a pipe, not a file"},
                                                         {"/dev/zero", "is a device, not a file"},
                                                         {file("loop.las"), "cannot be opened"},
                                                         {folder.path().string(), "is a directory without"}};
    for (const auto& [name, reason] : names) {
        EXPECT_EQ(run({"scancast", "info", name}), 1) << name;
        EXPECT_THAT(lastError, HasSubstr(reason));
        EXPECT_EQ(run({"scancast", "render", name, "--backend", "cpu", "-o", file("a.png")}), 1) << name;
        EXPECT_THAT(lastError, HasSubstr(reason));
    }
    EXPECT_EQ(run({"scancast", "serve", "--config", file("pipe.las")}), 1);
    EXPECT_THAT(lastError, HasSubstr("is a pipe, not a file"));
    const auto server = serve({file("pipe.las"), "/dev/zero", file("link.scan"), file("ball.las")});
    EXPECT_TRUE(answers());
    EXPECT_THAT(server->err(), HasSubstr("pipe.las is a pipe, not a file"));
}

}  // namespace
}  // namespace scancast::test
