// Kept clouds have an end: who goes, who stays, and that nothing else in the folder is touched.
#include "server/catalog/kept_clouds.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <string>
#include <vector>

#include "files/unique_fd.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

class KeptCloudsTest : public testing::Test {
  protected:
    /// Of so many bytes, last used so many seconds ago.
    fs::path put(const std::string& name, std::size_t bytes, int secondsAgo) {
        const fs::path path = folder_.write(name, std::string(bytes, 'x'));
        const timespec used{.tv_sec = 1'700'000'000 - secondsAgo, .tv_nsec = 0};
        const timespec times[2] = {used, {.tv_sec = 0, .tv_nsec = UTIME_OMIT}};
        EXPECT_EQ(::utimensat(AT_FDCWD, path.c_str(), times, 0), 0);
        return path;
    }
    KeptCloudsOptions options(std::uint64_t limit) {
        return {folder_.path(), limit, [this](const std::string& note) { notes_.push_back(note); }};
    }

    const test::TemporaryFolder folder_;
    std::vector<std::string> notes_;
    const std::string a = "a-0000000000000001.scan", b = "b-0000000000000002.scan",
                      c = "c-0000000000000003.scan";
};

TEST_F(KeptCloudsTest, NamesOfKeptCloudsAreKnown) {
    EXPECT_TRUE(isKeptName("town-0123456789abcdef.scan"));
    EXPECT_TRUE(isKeptName("my-town-0123456789abcdef.scan"));
    for (const char* other : {"town.scan", "-0123456789abcdef.scan", "town-0123456789abcdeg.scan",
                              "town-0123456789abcdef.scan.partial", "town-123456789abcdef.scan",
                              "town-0123456789abcdef.las", ".scan", ""})
        EXPECT_FALSE(isKeptName(other)) << other;
    KeptClouds kept(options(100));
    EXPECT_TRUE(isKeptName(kept.pathOf("town", 7).filename().string()));
}

TEST_F(KeptCloudsTest, WhatWasNotUsedForLongestMakesRoom) {
    const fs::path oldest = put(b, 40, 300), old = put(c, 40, 200), fresh = put(a, 40, 100);
    KeptClouds kept(options(150));
    EXPECT_EQ(kept.stats().bytes, 120U);
    ASSERT_TRUE(kept.open(oldest)) << "it has been used now, and is closed again";
    const auto room = kept.makeRoom(60);
    ASSERT_TRUE(room) << room.error().message;
    EXPECT_TRUE(fs::exists(oldest));
    EXPECT_FALSE(fs::exists(old));
    EXPECT_TRUE(fs::exists(fresh));
    EXPECT_EQ(kept.stats().evicted, 1U);
    EXPECT_EQ(kept.stats().bytes, 80U);
    ASSERT_EQ(notes_.size(), 1U);
    EXPECT_THAT(notes_[0], testing::HasSubstr(c));
    EXPECT_FALSE(kept.makeRoom(150)) << "what is promised is taken";
}

TEST_F(KeptCloudsTest, WhatSomebodyHasOpenStays) {
    const fs::path served = put(a, 60, 300), other = put(b, 60, 100);
    KeptClouds elsewhere(options(1000)), kept(options(150));  // as two servers share a folder
    {
        const auto open = elsewhere.open(served);
        ASSERT_TRUE(open);
        ASSERT_TRUE(kept.makeRoom(50));
        EXPECT_TRUE(fs::exists(served));
        EXPECT_FALSE(fs::exists(other));
        const auto refused = kept.makeRoom(140);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::ResourceLimit);
        EXPECT_THAT(refused.error().message, testing::HasSubstr("in use"));
    }
    ASSERT_TRUE(kept.makeRoom(140)) << "now that it is closed";
    EXPECT_FALSE(fs::exists(served));
    EXPECT_EQ(elsewhere.open(served).error().code, ErrorCode::NotFound);
}

TEST_F(KeptCloudsTest, OfWhatIsLargerThanAllNothingGoesForIt) {
    const fs::path one = put(a, 60, 300);
    KeptClouds kept(options(100));
    const auto refused = kept.makeRoom(101);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, testing::HasSubstr("larger than all that may be kept"));
    EXPECT_TRUE(fs::exists(one));
}

TEST_F(KeptCloudsTest, NothingElseInTheFolderIsTouched) {
    fs::create_directory(folder_ / "programs");
    folder_.write("programs/x.program", std::string(30, 'p'));
    for (const char* name : {"town.scan", "notes.txt", "mine.partial"}) put(name, 500, 1000);
    fs::create_symlink(folder_ / "town.scan", folder_ / "l-0123456789abcdef.scan");
    const fs::path one = put(a, 60, 300);
    KeptClouds kept(options(100));
    EXPECT_EQ(kept.stats().bytes, 90U) << "programs count";
    ASSERT_TRUE(kept.makeRoom(70));
    EXPECT_FALSE(fs::exists(one));
    EXPECT_EQ(folder_.entries(), 5U);
}

TEST_F(KeptCloudsTest, WhatBecameLargerThanThoughtMakesRoomAfterwards) {
    const fs::path old = put(a, 60, 300);
    KeptClouds kept(options(150));
    {
        const auto room = kept.makeRoom(50);
        ASSERT_TRUE(room);
        EXPECT_TRUE(fs::exists(old));
        put(b, 120, 0);
    }
    EXPECT_FALSE(fs::exists(old));
    EXPECT_TRUE(fs::exists(folder_ / b));
}

TEST_F(KeptCloudsTest, UnfinishedFilesGoUnlessSomebodyWritesThem) {
    put(a + ".partial", 10, 0);
    const UniqueFd writing(::open(put(b + ".partial", 10, 0).c_str(), O_RDWR | O_CLOEXEC));
    ASSERT_EQ(::flock(writing.get(), LOCK_EX | LOCK_NB), 0);
    const KeptClouds kept(options(100));
    EXPECT_FALSE(fs::exists(folder_ / (a + ".partial")));
    EXPECT_TRUE(fs::exists(folder_ / (b + ".partial")));
}

TEST_F(KeptCloudsTest, WithoutALimitItIsATenthOfTheDisk) {
    const KeptClouds kept(options(0));
    EXPECT_GT(kept.stats().limit, 0U);
}

}  // namespace
}  // namespace scancast
