// What the outside does to the programs: signals, readers that go away, no room for a file, and names of
// files that lead to something else.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

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

TEST_F(OutsideProgram, SignalsOfAdministratorsAreSaidAndEndNothing) {
    generate("ball.las");
    const auto server = serve({file("ball.las")});
    for (const int signal : {SIGHUP, SIGUSR1, SIGUSR2}) server->signal(signal);
    EXPECT_TRUE(says(*server, "Reloaded: nothing has changed."));
    EXPECT_TRUE(says(*server, "SIGUSR1 and SIGUSR2 mean nothing here"));
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
    fs::create_directory(folder / "empty");
    const std::pair<std::string, const char*> names[] = {{file("pipe.las"), "is a pipe, not a file"},
                                                         {file("link.scan"), "is a pipe, not a file"},
                                                         {"/dev/zero", "is a device, not a file"},
                                                         {file("loop.las"), "cannot be opened"},
                                                         {file("empty"), "there is no scan in this folder"}};
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

/// Programs that lie together as they do when they are installed, but for an importer that hangs as soon as it runs.
class HangingImporter : public OutsideProgram {
  protected:
    void SetUp() override {
        generate("ball.las");
        std::ofstream(folder / "hangs.pcd") << "# .PCD v0.7\nVERSION 0.7\n";
        const fs::path programs = SCANCAST_BIN_DIR, mine = folder / "programs";
        fs::create_directories(mine);
        std::error_code error;
        fs::create_hard_link(programs / "scancast", mine / "scancast", error);
        if (error) fs::copy_file(programs / "scancast", mine / "scancast");
        fs::create_symlink(programs / "scancast-sandbox", mine / "scancast-sandbox");
        importer = (mine / "scancast-import-pcl").string();
        std::ofstream(importer) << "#!/bin/sh\nkill -STOP $$\n";
        fs::permissions(importer, fs::perms::owner_all);
        serverProgram = fs::relative(mine / "scancast", programs).string();
    }
    /// The number of its process when it hangs; 0 when it never does.
    pid_t hanging() const {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (std::chrono::steady_clock::now() < end) {
            for (const auto& entry : fs::directory_iterator("/proc")) {
                const std::string words = contentOf(entry.path() / "cmdline");
                // Before, it is the program that starts it.
                if (words.starts_with("/bin/sh") && words.find(importer) != std::string::npos &&
                    stateOf(entry.path()) == 'T')
                    return pid_t(std::stol(entry.path().filename().string()));
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return 0;
    }
    static char stateOf(const fs::path& process) {
        const std::string facts = contentOf(process / "stat");
        const auto at = facts.rfind(')');
        return at == std::string::npos || at + 2 >= facts.size() ? '\0' : facts[at + 2];
    }
    /// Nobody may be there to collect it.
    static bool ends(pid_t pid) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (std::chrono::steady_clock::now() < end) {
            const char state = stateOf("/proc/" + std::to_string(pid));
            if (state == '\0' || state == 'Z' || state == 'X') return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return false;
    }
    std::unique_ptr<Process> serveBoth(std::vector<std::string> flags = {}) {
        flags.insert(flags.end(), {"--backend", "cpu", file("hangs.pcd"), file("ball.las")});
        return serve(
            flags, [] {}, "/api/v1/clouds/ball/snapshot.jpg?width=32&height=16");
    }

    std::string importer;
};

TEST_F(HangingImporter, HoldsUpNothingAndDiesWithTheServer) {
    const auto process = serveBoth();
    EXPECT_THAT(process->err(), HasSubstr("importers are "));
    const pid_t pid = hanging();
    ASSERT_NE(pid, 0) << process->err();
    process->signal(SIGKILL);
    EXPECT_EQ(process->wait(), -1);
    EXPECT_TRUE(ends(pid)) << "an importer outlived its server";
}

TEST_F(HangingImporter, IsStoppedWhenItIsSilentForTooLong) {
    const auto process = serveBoth({"--importer-silence", "1"});
    EXPECT_TRUE(says(*process, "hangs: it sent nothing for 1 seconds")) << process->err();
    process->signal(SIGTERM);
    EXPECT_EQ(process->wait(), 0);
}

TEST_F(OutsideProgram, ImportersAreShutInAsTheFlagSays) {
    std::string said;
    ASSERT_EQ(run({"scancast", "--list-backends"}, &said), 0) << lastError;
    EXPECT_THAT(said, HasSubstr("importers are "));
    generate("ball.las");
    EXPECT_THAT(serve({"--importer-sandbox", "off", file("ball.las")})->err(),
                HasSubstr("importers are not shut in"));
    EXPECT_EQ(run({"scancast", "serve", "--importer-memory", "1M", file("ball.las")}), 1);
    EXPECT_THAT(lastError, HasSubstr("--importer-memory: 64M is the least"));
    EXPECT_NE(run({"scancast", "ingest", "--importer-sandbox", "perhaps", file("ball.las"), "-o",
                   file("ball.scan")}),
              0);
    EXPECT_THAT(lastError, HasSubstr("--importer-sandbox"));
}

}  // namespace
}  // namespace scancast::test
