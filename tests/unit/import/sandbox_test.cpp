// Importers that try what they must not do, shut in by each of the ways that this machine has. What it has not is skipped, and said.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "renderer/cloud/import/stream/importer_launch.hpp"
#include "renderer/cloud/import/stream/importer_source.hpp"
#include "renderer/cloud/import/stream/sandbox_report.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

constexpr int prevented = 0, couldDoIt = 20;  // exit statuses of trespassing-importer
constexpr const char* folderOfPrograms = SCANCAST_FAKE_IMPORTERS;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool leaksAreLookedFor = true;  // by a process that traces: both are allowed then
#else
constexpr bool leaksAreLookedFor = false;
#endif

/// The parameter: what to do without, as `scancast-sandbox --without` has it.
class Sandbox : public ::testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        report_ = output("--report" + without());
        shutsFiles_ = report_.find("files by Landlock") != std::string::npos ||
                      report_.find("files by a namespace") != std::string::npos;
        filtersCalls_ = report_.find("seccomp (") != std::string::npos;
        token_ = folder_.write("token", "secret");
        fs::permissions(token_, fs::perms::owner_read | fs::perms::owner_write);
    }

    static std::string without() {
        return *GetParam() == '\0' ? std::string() : std::string(" --without ") + GetParam();
    }
    static std::string launcher() { return std::string(folderOfPrograms) + "/scancast-sandbox"; }
    std::string output(const std::string& words) const {
        const auto to = folder_.path() / "output";
        (void)std::system((launcher() + " " + words + " > '" + to.string() + "'").c_str());
        std::ifstream file(to);
        return {std::istreambuf_iterator(file), {}};
    }
    /// The exit status of the importer, shut in; as a shell has it, 128 and more for signals. It writes to a pipe, as it always does.
    int attempt(const std::string& what, const std::string& options = "") const {
        const auto scan = folder_.write("scan", what);
        return attemptWith(scan, options);
    }
    int attemptWith(const fs::path& scan, const std::string& options = "",
                    const std::string& file = "/proc/self/fd/3") const {
        const auto status = folder_.path() / "status";
        const std::string command = "{ " + launcher() + without() + " " + options + " " + folderOfPrograms +
                                    "/trespassing-importer " + file + " 3< '" + scan.string() +
                                    "' 2>/dev/null; echo $? > '" + status.string() +
                                    "'; } 2>/dev/null | cat > /dev/null";
        (void)std::system(command.c_str());
        int result = -1;
        std::ifstream(status) >> result;
        return result;
    }

    const TemporaryFolder folder_;
    fs::path token_;
    std::string report_;
    bool shutsFiles_ = false, filtersCalls_ = false;
};

}  // namespace

// Or the tests below would pass whatever the sandbox does.
TEST_P(Sandbox, WithoutOneAllOfItCanBeDone) {
    for (const std::string& what :
         {"read " + token_.string(), "list " + folder_.path().string(),
          "write " + (folder_.path() / "new").string(), std::string("socket"), std::string("start"),
          std::string("become /bin/sh"), "signal " + std::to_string(::getpid()),
          "limit " + std::to_string(::getpid()), std::string("outlive"), std::string("overwrite-scan"),
          std::string("privilege")})
        EXPECT_EQ(attempt(what, "--sandbox off"), couldDoIt) << what;
}

TEST_P(Sandbox, SoundImportersNoticeNothing) {
    EXPECT_EQ(attempt("thread"), prevented);
    EXPECT_EQ(attempt("read-twice"), prevented);
    EXPECT_EQ(attempt("die"), 128 + SIGTERM) << "by its own signals, as when it aborts";
}

TEST_P(Sandbox, FilesOfOthersAreNeitherReadNorWritten) {
    if (!shutsFiles_) GTEST_SKIP() << "FILES ARE NOT SHUT HERE: " << report_;
    const auto token = token_.string();
    for (const std::string& what :
         {"read " + token, "list " + folder_.path().string(), std::string("read /etc/passwd"),
          std::string("list /home"), "read /proc/" + std::to_string(::getpid()) + "/environ",
          "write " + (folder_.path() / "new").string(), std::string("write /tmp/scancast-trespassed"),
          "write " + token, "remove " + token, std::string("overwrite-scan"), std::string("empty-scan")})
        EXPECT_EQ(attempt(what), prevented) << what;
    EXPECT_EQ(fs::file_size(token_), 6u);
    EXPECT_FALSE(fs::exists(folder_.path() / "new"));
    EXPECT_FALSE(fs::exists("/tmp/scancast-trespassed"));
}

TEST_P(Sandbox, OfAnOctreeItsFolderIsReadAndNothingBesides) {
    if (!shutsFiles_) GTEST_SKIP() << "FILES ARE NOT SHUT HERE: " << report_;
    fs::create_directories(folder_.path() / "octree");
    const auto write = [&](const std::string& what) {
        std::ofstream(folder_.path() / "octree" / "what") << what;
    };
    write("leave-folder what");
    EXPECT_EQ(attemptWith(folder_.path() / "octree", "", "/proc/self/fd/3/what"), couldDoIt);
    write("leave-folder ../token");
    EXPECT_EQ(attemptWith(folder_.path() / "octree", "", "/proc/self/fd/3/what"), prevented);
    EXPECT_EQ(attemptWith(folder_.path() / "octree", "--sandbox off", "/proc/self/fd/3/what"), couldDoIt);
}

TEST_P(Sandbox, OtherProgramsAreNotStarted) {
    if (!shutsFiles_) GTEST_SKIP() << "FILES ARE NOT SHUT HERE: " << report_;
    EXPECT_EQ(attempt("become /bin/sh"), prevented);
    EXPECT_EQ(attempt("become /usr/bin/env"), prevented);
    const auto own = folder_.write("script", "#!/bin/sh\nexit 20\n");
    fs::permissions(own, fs::perms::owner_all);
    EXPECT_EQ(attempt("become " + own.string()), prevented);
}

TEST_P(Sandbox, SystemCallsOfTheListAreRefused) {
    if (!filtersCalls_) GTEST_SKIP() << "SYSTEM CALLS ARE NOT FILTERED HERE: " << report_;
    for (const std::string& what :
         {std::string("socket"), std::string("ring"), std::string("outlive"), std::string("leave-group"),
          std::string("unshare"), std::string("key"), std::string("program-in-memory"),
          std::string("privilege"), "signal " + std::to_string(::getpid()),
          "limit " + std::to_string(::getpid())})
        EXPECT_EQ(attempt(what), prevented) << what;
    for (const char* what : {"start", "trace"})
        EXPECT_EQ(attempt(what), leaksAreLookedFor ? couldDoIt : prevented) << what;
    EXPECT_EQ(attempt("module"), 128 + SIGSYS) << "the most dangerous end it";
}

TEST_P(Sandbox, RequiredMeansCompleteOrNothing) {
    const bool complete = report_.find("without:") == std::string::npos;
    EXPECT_EQ(attempt("thread", "--sandbox require"), complete ? prevented : 126) << report_;
}

INSTANTIATE_TEST_SUITE_P(AsItIs, Sandbox, ::testing::Values(""));
INSTANTIATE_TEST_SUITE_P(OlderKernel, Sandbox, ::testing::Values("landlock"));

namespace {

class NoSandbox : public Sandbox {};

}  // namespace

TEST_P(NoSandbox, IsNoneToBeRequired) {
    EXPECT_THAT(report_, HasSubstr("without: this kernel has no Landlock"));
    EXPECT_THAT(report_, HasSubstr("they can use the network"));
    EXPECT_EQ(attempt("thread", "--sandbox require"), 126);
}

// The superuser's importers are another user's then.
TEST_P(NoSandbox, ReadsAllTheSameAndNoSecretsOfTheSuperuser) {
    const int thread = attempt("thread");
    if (::geteuid() != 0) {
        EXPECT_EQ(thread, prevented);
        EXPECT_EQ(attempt("read " + token_.string()), couldDoIt) << "as " << report_ << " says";
        return;
    }
    if (thread == 126) GTEST_SKIP() << "ANOTHER USER MAY NOT RUN WHAT IS BUILT HERE: " << folderOfPrograms;
    EXPECT_EQ(thread, prevented);
    EXPECT_EQ(attempt("read " + token_.string()), prevented);
    EXPECT_EQ(attempt("signal " + std::to_string(::getpid())), prevented);
}

INSTANTIATE_TEST_SUITE_P(OlderKernel, NoSandbox, ::testing::Values("landlock,namespaces,seccomp"));

TEST(SandboxReport, SaysWhatThisMachineHas) {
    const auto report = askSandbox();
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->text, HasSubstr("no privileges"));
    EXPECT_EQ(report->complete, report->text.find("without:") == std::string::npos) << report->text;
    if (!report->complete) GTEST_SKIP() << "THE SANDBOX IS NOT COMPLETE HERE: " << report->text;
}

namespace {

class ShutInImporter : public ::testing::Test {
  protected:
    const TemporaryFolder folder_;
    const ImporterProgram program_{.name = "trespassing-importer"};
    ImportOptions options_{.importerDirectory = SCANCAST_FAKE_IMPORTERS};
};

}  // namespace

// By all that starts importers in the product, not by the launcher alone.
TEST_F(ShutInImporter, IsShutInUnlessItIsSwitchedOff) {
    const auto token = folder_.write("token", "secret");
    const auto scan = folder_.write("scan.pcd", "read " + token.string());
    const auto open = [&] {
        return summarizeOpened(ImporterSource::create(program_, *ScanInput::open(scan), options_));
    };
    options_.importerSandbox = ImporterSandbox::Off;
    const auto trespassed = open();
    ASSERT_FALSE(trespassed);
    EXPECT_THAT(trespassed.error().message, HasSubstr("exit status 20: it could read"));
    const auto report = askSandbox();
    ASSERT_TRUE(report) << report.error().message;
    options_.importerSandbox = ImporterSandbox::Require;
    const auto shut = open();
    if (!report->complete) {
        ASSERT_FALSE(shut);
        EXPECT_THAT(shut.error().message, HasSubstr("--importer-sandbox=require"));
        GTEST_SKIP() << "THE SANDBOX IS NOT COMPLETE HERE: " << report->text;
    }
    ASSERT_TRUE(shut) << shut.error().message;
    EXPECT_EQ(shut->points, 10u);
    options_.importerSandbox = ImporterSandbox::Auto;
    EXPECT_TRUE(open());
}

TEST_F(ShutInImporter, WhatEndsItIsSaid) {
    const auto scan = folder_.write("scan.pcd", "module");
    const auto report = askSandbox();
    if (!report || report->text.find("seccomp (") == std::string::npos)
        GTEST_SKIP() << "SYSTEM CALLS ARE NOT FILTERED HERE";
    const auto read = summarizeOpened(ImporterSource::create(program_, *ScanInput::open(scan), options_));
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message, HasSubstr("a system call that importers may not make"));
}

}  // namespace scancast::test
