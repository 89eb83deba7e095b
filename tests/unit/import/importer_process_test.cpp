// Importers that crash, hang, lie or flood cost an error message that names the file, nothing else.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "renderer/cloud/import/stream/importer_source.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

class FakeImporter : public ::testing::Test {
  protected:
    Expected<std::unique_ptr<ImporterSource>> open(const std::string& behaviour) {
        file_ = folder_.write("scan of " + behaviour + ".pcd", behaviour);
        return ImporterSource::create(program_, *ScanInput::open(file_), options_);
    }

    void expectError(const std::string& behaviour, ErrorCode code, const char* reason) {
        const auto scan = summarizeOpened(open(behaviour));
        ASSERT_FALSE(scan) << behaviour;
        EXPECT_EQ(name(scan.error().code), name(code)) << scan.error().message;
        EXPECT_THAT(scan.error().message, HasSubstr(file_.string()));
        EXPECT_THAT(scan.error().message, HasSubstr(reason));
        if (code == ErrorCode::Importer) {
            EXPECT_THAT(scan.error().message, HasSubstr("fake-importer"));
        }
        expectNoChildren();
    }

    /// Neither running nor waiting to be collected.
    static void expectNoChildren() { EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1); }

    TemporaryFolder folder_;
    std::filesystem::path file_;
    ImporterProgram program_{.name = "fake-importer"};
    ImportOptions options_{.importerDirectory = SCANCAST_FAKE_IMPORTERS, .importerSilenceSeconds = 1};
};

}  // namespace

TEST_F(FakeImporter, GoodOneIsRead) {
    const auto scan = summarizeOpened(open("good"));
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->points, 10U);
    expectNoChildren();
}

TEST_F(FakeImporter, RunsInASmallWorld) {
    ::setenv("SCANCAST_TEST_SECRET", "token", 1);
    const int inherited = ::dup(STDERR_FILENO);  // without close-on-exec
    const auto scan = summarizeOpened(open("inspect"));
    ::close(inherited);
    ASSERT_TRUE(scan) << scan.error().message;
}

TEST_F(FakeImporter, Crashes) {
    expectError("crash", ErrorCode::Importer, "crashed (signal 11, Segmentation fault) while reading");
    expectError("crash-midway", ErrorCode::Importer, "crashed (signal 11");
    expectError("crash-midway", ErrorCode::Importer, "the file is probably damaged");
    expectError("abort", ErrorCode::Importer, "crashed (signal 6");
}

TEST_F(FakeImporter, Fails) {
    expectError("status", ErrorCode::Importer, "ended with exit status 3: the scanner is out of paper");
    expectError("silent-end", ErrorCode::Importer, "broke off at byte 0");
    expectError("failure", ErrorCode::Truncated, "it ends at byte 7");
}

TEST_F(FakeImporter, Hangs) {
    expectError("hang", ErrorCode::Importer, "hangs: it sent nothing for 1 seconds");
    expectError("hang-midway", ErrorCode::Importer, "sent nothing for 1 seconds");
    expectError("hang-with-noise", ErrorCode::Importer, "sent nothing for 1 seconds");
}

// The group is ended, not only the program: a child that keeps the pipe open must not outlive it.
TEST_F(FakeImporter, ChildrenOfTheImporterEndWithIt) {
    pid_t group = 0;
    options_.importerSandbox = ImporterSandbox::Off;  // which would let it have no child
    {
        const auto file = folder_.write("a", "child-hangs");
        auto process = ImporterProcess::start(program_, *ScanInput::open(file), options_);
        ASSERT_TRUE(process);
        group = (*process)->pid();
        std::array<std::byte, 136> header{};
        ASSERT_EQ(readFully(**process, header).value_or(0), header.size());
        EXPECT_EQ(::kill(-group, 0), 0);
    }
    expectNoChildren();
    // The grandchild is collected by init, in its own time.
    bool gone = false;
    for (int i = 0; i < 500 && !gone; ++i) {
        gone = ::kill(-group, 0) != 0;
        if (!gone) ::usleep(10000);
    }
    // Where nobody collects orphans (a container without init) it stays as a zombie, but a dead one.
    if (!gone) GTEST_SKIP() << "orphans are not collected on this machine";
}

// It is to die with the process, which the kernel knows as the thread that starts it: builders read each batch by a thread
// of its own.
TEST_F(FakeImporter, OutlivesTheThreadThatAskedForIt) {
    Expected<std::unique_ptr<ImporterSource>> source = fail(ErrorCode::Internal, {});
    std::thread([&] { source = open("good"); }).join();
    ::usleep(100'000);  // enough for the kernel to end it, if it did
    const auto scan = summarizeOpened(std::move(source));
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->points, 10U);
}

TEST_F(FakeImporter, IsWaitedForNoLongerWhenAskedToStop) {
    std::stop_source stop;
    options_.stop = stop.get_token();
    options_.importerSilenceSeconds = 600;
    auto source = open("hang-midway");
    ASSERT_TRUE(source) << source.error().message;
    stop.request_stop();
    PointBatch batch;
    auto more = (*source)->read(batch);
    while (more && *more) more = (*source)->read(batch);
    ASSERT_FALSE(more);
    EXPECT_EQ(name(more.error().code), name(ErrorCode::Cancelled));
}

// Silent, but not hanging: it takes in more and more of its file.
TEST_F(FakeImporter, ReadingOnIsNoSilence) {
    const auto scan = summarizeOpened(open("read-long"));
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->points, 10u);
}

TEST_F(FakeImporter, ProcessorTimeIsLimited) {
    options_.importerProcessorSeconds = 1;
    options_.importerSilenceSeconds = 600;
    expectError("spin", ErrorCode::Importer, "more processor time than it is allowed (--importer-time)");
}

TEST_F(FakeImporter, LeftAloneMidwayIsEnded) {
    {
        auto source = open("flood");
        ASSERT_TRUE(source);
        PointBatch batch;
    }
    expectNoChildren();
}

TEST_F(FakeImporter, HangingAfterItsEndDelaysNobody) {
    options_.importerSilenceSeconds = 600;
    const auto scan = summarizeOpened(open("hang-after-end"));
    ASSERT_TRUE(scan) << scan.error().message;
    expectNoChildren();
}

TEST_F(FakeImporter, Lies) {
    expectError("garbage", ErrorCode::Importer, "does not start as a point stream does");
    expectError("nan", ErrorCode::Importer, "a coordinate is NaN or infinite");
    expectError("lie-more", ErrorCode::Importer, "more points than the 10 that it declared");
    expectError("lie-fewer", ErrorCode::Importer, "declared 10 points, sent 9");
}

TEST_F(FakeImporter, Floods) {
    expectError("flood", ErrorCode::Importer, "more points than such a file can hold");
    const auto scan = summarizeOpened(open("flood-errors"));
    EXPECT_TRUE(scan) << scan.error().message;
}

TEST_F(FakeImporter, MemoryIsLimited) {
    if (test::sanitized) GTEST_SKIP() << "sanitizers need more address space than any limit";
    options_.importerMemoryLimit = std::uint64_t(1) << 30;
    options_.importerSilenceSeconds = 30;
    expectError("allocate", ErrorCode::Importer, "crashed (signal 6");
    // What is only reserved, and never written to, counts, too.
    expectError("reserve", ErrorCode::Importer, "ended with exit status 16");
}

TEST_F(FakeImporter, MemoryIsUnlimitedWhenToldSo) {
    options_.importerMemoryLimit = 0;
    EXPECT_TRUE(summarizeOpened(open("reserve")));
}

TEST_F(FakeImporter, MissingProgram) {
    options_.importerDirectory = folder_.path();
    expectError("good", ErrorCode::Importer, "is not there (looked in ");
}

TEST_F(FakeImporter, ProgramThatCannotBeStarted) {
    options_.importerDirectory = folder_.path();
    const auto program = folder_.write("fake-importer", "#!/nowhere/interpreter\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    expectError("good", ErrorCode::Importer, "cannot be started");
}

TEST_F(FakeImporter, ProgramWhoseInterpreterIsMissing) {
    options_.importerDirectory = folder_.path();
    const auto program =
        folder_.write("fake-importer",
                      "#!/bin/sh\necho \"/usr/bin/env: 'node': No such file or directory\" >&2\nexit 127\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    expectError("good", ErrorCode::Importer, "cannot be started: Node.js is missing");
}

// Nothing in a path may mean anything to whatever starts the program.
TEST_F(FakeImporter, PathsAreNeverCommands) {
    const std::string hostile = "$(touch broken) `touch broken`; touch broken & 'a' \"b\" * \\ \n-c";
    const auto folder = folder_.path() / hostile;
    std::filesystem::create_directory(folder);
    std::filesystem::create_symlink(std::filesystem::path(SCANCAST_FAKE_IMPORTERS) / "fake-importer",
                                    folder / hostile);
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder_.path());
    options_.importerDirectory = folder;
    program_.name = hostile;
    const auto file = folder_.write(hostile + ".pcd", "good");
    const auto scan = summarizeOpened(ImporterSource::create(program_, *ScanInput::open(file), options_));
    std::filesystem::current_path(before);
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->points, 10U);
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "broken"));
}

// What somebody puts in the place of a file that is open already: the importer reads the file, and waits for
// no pipe.
TEST_F(FakeImporter, ReadsWhatIsOpenNotWhatHasItsNameByNow) {
    const auto file = folder_.write("scan.pcd", "good");
    const auto input = ScanInput::open(file);
    ASSERT_TRUE(input);
    std::filesystem::remove(file);
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    const auto scan = summarizeOpened(ImporterSource::create(program_, *input, options_));
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->points, 10U);
}

// A file name that looks like an option never reaches the program.
TEST_F(FakeImporter, FileNamesAreNotOptions) {
    const auto file = folder_.write("--help", "good");
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder_.path());
    const auto scan = summarizeOpened(ImporterSource::create(program_, *ScanInput::open("--help"), options_));
    std::filesystem::current_path(before);
    EXPECT_TRUE(scan) << scan.error().message;
}

}  // namespace scancast::test
