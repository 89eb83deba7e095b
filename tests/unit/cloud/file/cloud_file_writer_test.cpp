// Whatever ends a writer, no file that looks finished is left behind, and the next run gets through.
#include "renderer/cloud/file/cloud_file_writer.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::vector<std::byte> block(std::size_t bytes) {
    return std::vector<std::byte>(bytes, std::byte(0x5a));
}

std::vector<std::string> namesIn(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

/// Runs `work` in a child process, which ends with its result.
pid_t inChild(const std::function<int()>& work) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(work());
    return child;
}

int resultOf(pid_t child) {
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return status;
}

TEST(CloudFileWriter, BlocksComeBackAndAreChecked) {
    const test::TemporaryFolder folder;
    const auto writer = CloudFileWriter::create(folder.path() / "a.scan").value();
    const auto first = writer->append(block(1000)).value(), second = writer->append(block(7)).value();
    EXPECT_EQ(first.offset, cloudHeaderBytes);
    EXPECT_EQ(second.offset, cloudHeaderBytes + 1000);
    EXPECT_EQ(writer->bytesWritten(), cloudHeaderBytes + 1007);
    EXPECT_EQ(writer->append({}).value(), BlockPlace{});
    EXPECT_EQ(writer->readBack(first).value(), block(1000));
    EXPECT_EQ(writer->readBack(second).value(), block(7));
    auto other = second;
    ++other.checksum;
    EXPECT_FALSE(writer->readBack(other));
    EXPECT_FALSE(writer->readBack({cloudHeaderBytes + 1005, 100, 0}));
}

TEST(CloudFileWriter, AnAbandonedFileIsRemoved) {
    const test::TemporaryFolder folder;
    {
        const auto writer = CloudFileWriter::create(folder.path() / "a.scan").value();
        ASSERT_TRUE(writer->append(block(1000)));
        EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{"a.scan.partial"});
        EXPECT_FALSE(CloudFile::open(folder.path() / "a.scan.partial"));
    }
    EXPECT_TRUE(namesIn(folder.path()).empty());
}

TEST(CloudFileWriter, AnOlderFileStaysUntilTheNewOneIsFinished) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.scan";
    const auto cloud = test::sampleCloud(500), other = test::sampleCloud(700);
    ASSERT_TRUE(test::writeCloudFile(path, cloud->octree, *cloud));
    {
        const auto writer = CloudFileWriter::create(path).value();
        ASSERT_TRUE(writer->append(block(1000)));
        EXPECT_EQ(CloudFile::open(path).value()->facts().points, 500u);
    }
    EXPECT_EQ(CloudFile::open(path).value()->facts().points, 500u);
    ASSERT_TRUE(test::writeCloudFile(path, other->octree, *other));
    EXPECT_EQ(CloudFile::open(path).value()->facts().points, 700u);
}

TEST(CloudFileWriter, WhatAnotherRunIsWritingIsRefused) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.scan";
    const auto cloud = test::sampleCloud(500);
    auto writer = CloudFileWriter::create(path).value();
    const auto parts = test::appendAll(*writer, cloud->octree, *cloud).value();
    const auto second = CloudFileWriter::create(path);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(second.error().message, HasSubstr("a.scan.partial: another run is writing"));
    ASSERT_TRUE(test::finish(*writer, parts)) << "the refused one must not have harmed it";
    EXPECT_TRUE(CloudFile::open(path));
    EXPECT_TRUE(CloudFileWriter::create(path)) << "finished, so no longer locked";
}

TEST(CloudFileWriter, WhatIsWithdrawnIsGoneAtOnceAndStaysSo) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.scan";
    const auto cloud = test::sampleCloud(500);
    const auto writer = CloudFileWriter::create(path).value();
    const auto parts = test::appendAll(*writer, cloud->octree, *cloud).value();
    writer->withdraw();
    EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{});
    // Somebody else's has the name by now, and keeps it.
    const auto other = CloudFileWriter::create(path).value();
    const auto finished = test::finish(*writer, parts);
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().code, ErrorCode::Cancelled);
    EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{"a.scan.partial"});
    const auto others = test::appendAll(*other, cloud->octree, *cloud).value();
    ASSERT_TRUE(test::finish(*other, others));
    other->withdraw();
    EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{"a.scan"}) << "too late";
}

TEST(CloudFileWriter, PlacesThatCannotBe) {
    const test::TemporaryFolder folder;
    const auto missing = CloudFileWriter::create(folder.path() / "none" / "a.scan");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::NotFound);
    fs::create_directory(folder.path() / "b.scan");
    ASSERT_EQ(::mkfifo((folder.path() / "c.scan").c_str(), 0600), 0);
    for (const char* name : {"b.scan", "c.scan", ""}) {
        const auto refused = CloudFileWriter::create(folder.path() / name);
        ASSERT_FALSE(refused) << name;
        EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument) << refused.error().message;
    }
    EXPECT_EQ(namesIn(folder.path()), (std::vector<std::string>{"b.scan", "c.scan"}));
}

TEST(CloudFileWriter, AFileThatCouldNotBeReadIsNotFinished) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.scan";
    const auto cloud = test::sampleCloud(500);
    {
        const auto writer = CloudFileWriter::create(path).value();
        auto parts = test::appendAll(*writer, cloud->octree, *cloud).value();
        parts.nodes[0].node.spacing = -1;
        const auto done = test::finish(*writer, parts);
        ASSERT_FALSE(done);
        EXPECT_THAT(done.error().message, HasSubstr("node 0"));
    }
    EXPECT_TRUE(namesIn(folder.path()).empty());
}

// A limit on the size of files refuses writes as a full disk does, and hits only the child.
TEST(CloudFileWriter, AFullDiskLeavesNothing) {
    const auto cloud = test::sampleCloud();
    for (const rlim_t limit : {rlim_t(0), rlim_t(100), rlim_t(5000), rlim_t(40000)}) {
        const test::TemporaryFolder folder;
        const auto path = folder.path() / "a.scan";
        const auto child = inChild([&] {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit small{limit, limit};
            if (::setrlimit(RLIMIT_FSIZE, &small) != 0) return 10;
            const auto written = test::writeCloudFile(path, cloud->octree, *cloud);
            if (written) return 11;
            if (written.error().code != ErrorCode::ResourceLimit) return 12;
            const auto& text = written.error().message;
            if (text.find(path.string() + ": there is no more room for it after ") != 0) return 13;
            return 0;
        });
        const int status = resultOf(child);
        ASSERT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 0) << "with room for " << limit << " bytes";
        EXPECT_TRUE(namesIn(folder.path()).empty());
    }
}

// Killed while it appends, at a moment that the child tells: what is left is no cloud file, and is taken
// over.
TEST(CloudFileWriter, KilledInTheMiddle) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.scan";
    const auto cloud = test::sampleCloud();
    int pipe[2];
    ASSERT_EQ(::pipe(pipe), 0);
    const auto child = inChild([&] {
        const auto writer = CloudFileWriter::create(path);
        if (!writer || !test::appendAll(**writer, cloud->octree, *cloud)) return 1;
        if (::write(pipe[1], "x", 1) != 1) return 1;
        for (;;) ::pause();
    });
    char told = 0;
    ASSERT_EQ(::read(pipe[0], &told, 1), 1);
    const auto during = CloudFileWriter::create(path);
    ASSERT_FALSE(during) << "it holds its lock";
    ::kill(child, SIGKILL);
    resultOf(child);
    ::close(pipe[0]);
    ::close(pipe[1]);
    EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{"a.scan.partial"});
    const auto left = CloudFile::open(folder.path() / "a.scan.partial");
    ASSERT_FALSE(left);
    EXPECT_THAT(left.error().message, HasSubstr("never finished"));
    ASSERT_TRUE(test::writeCloudFile(path, cloud->octree, *cloud));
    EXPECT_TRUE(CloudFile::open(path));
    EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{"a.scan"});
}

// Killed at any moment of a loop of whole writings: either there is no file, or it is whole.
TEST(CloudFileWriter, KilledAtAnyMoment) {
    const auto cloud = test::sampleCloud(500);
    for (int round = 0; round < 20; ++round) {
        const test::TemporaryFolder folder;
        const auto path = folder.path() / "a.scan";
        const auto child = inChild([&] {
            while (test::writeCloudFile(path, cloud->octree, *cloud)) {
            }
            return 1;
        });
        ::usleep(useconds_t(200 + 700 * round));
        ::kill(child, SIGKILL);
        ASSERT_TRUE(WIFSIGNALED(resultOf(child)));
        if (fs::exists(path)) {
            const auto file = CloudFile::open(path);
            ASSERT_TRUE(file) << file.error().message;
            for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i) EXPECT_TRUE((*file)->samples(i));
        }
        ASSERT_TRUE(test::writeCloudFile(path, cloud->octree, *cloud));
        EXPECT_TRUE(CloudFile::open(path));
    }
}

}  // namespace
}  // namespace scancast
