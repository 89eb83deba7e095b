// Files and folders that are locked while somebody writes them: what a process that ended left is swept, and nothing else.
#include "files/unfinished_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <thread>

#include "files/output_file.hpp"
#include "files/owned_folder.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

bool everything(std::string_view) {
    return true;
}

TEST(UnfinishedFile, IsSweptWhenNobodyWritesIt) {
    const test::TemporaryFolder folder;
    folder.write("left.scan.partial", "half");
    folder.write("whole.scan", "whole");
    const auto writing = takeUnfinished(folder / "now.scan", Readers::AsUsual);
    const auto another = makeUnfinished(folder / "now.scan", Readers::AsUsual);
    ASSERT_TRUE(writing && another);
    EXPECT_EQ(sweepUnfinished(folder, [](std::string_view name) { return name.starts_with("other"); }), 0U);
    EXPECT_EQ(sweepUnfinished(folder, everything), 1U);
    EXPECT_EQ(folder.entries(), 3U) << "the whole one, and two that are being written";
}

TEST(UnfinishedFile, IsTakenOverFromWhoEndedAndNotFromWhoWrites) {
    const test::TemporaryFolder folder;
    folder.write("a.scan.partial", "half");
    auto first = takeUnfinished(folder / "a.scan", Readers::AsUsual);
    ASSERT_TRUE(first) << first.error().message;
    EXPECT_EQ(test::contentOf(folder / "a.scan.partial"), "");
    const auto second = takeUnfinished(folder / "a.scan", Readers::AsUsual);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(folder.entries(), 1U) << "the first one's is still there";
}

TEST(UnfinishedFile, IsForItsOwnerAloneWhereThatIsAsked) {
    const test::TemporaryFolder folder;
    const auto file = makeUnfinished(folder / "secret", Readers::OwnerAlone);
    ASSERT_TRUE(file);
    struct stat info {};
    ASSERT_EQ(::fstat(file->fd.get(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0600U);
    ASSERT_TRUE(writeWholeFile(folder.file("kept"), {}, Readers::OwnerAlone));
    ASSERT_EQ(::stat(folder.file("kept").c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0600U);
}

TEST(OwnedFolder, IsSweptWhenNobodyHasIt) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "scancast-spill-left");
    folder.write("scancast-spill-left/cloud.scan", "left");
    std::filesystem::create_directory(folder / "other");
    {
        const auto mine = OwnedFolder::make(folder);
        ASSERT_TRUE(mine) << mine.error().message;
        struct stat info {};
        ASSERT_EQ(::stat(mine->path().c_str(), &info), 0);
        EXPECT_EQ(info.st_mode & 0777, 0700U);
        EXPECT_EQ(sweepOwnedFolders(folder), 1U);
        EXPECT_EQ(folder.entries(), 2U) << "mine, and what is none of ours";
    }
    EXPECT_EQ(folder.entries(), 1U);
    EXPECT_FALSE(OwnedFolder::make(folder / "none"));
}

TEST(OwnedFolder, IsNotSweptWhileItIsMade) {
    const test::TemporaryFolder folder;
    std::jthread sweeper([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) sweepOwnedFolders(folder);
    });
    for (int i = 0; i < 2000; ++i) {
        const auto mine = OwnedFolder::make(folder);
        ASSERT_TRUE(mine) << mine.error().message;
        std::this_thread::yield();
        ASSERT_TRUE(std::filesystem::exists(mine->path())) << "made " << i;
    }
}

}  // namespace
}  // namespace scancast
