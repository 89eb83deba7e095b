#include "files/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

std::span<const std::byte> bytes(const std::string& text) {
    return std::as_bytes(std::span(text));
}

TEST(OutputFile, AppearsUnderItsNameOnlyWhenFinished) {
    const test::TemporaryFolder folder;
    const std::string name = folder.file("scan.las");
    auto file = OutputFile::create(name);
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write(bytes("hello world")));
    EXPECT_FALSE(std::filesystem::exists(name));
    ASSERT_TRUE(file->overwrite(6, bytes("W")));
    ASSERT_TRUE(file->finish());
    EXPECT_EQ(test::contentOf(name), "hello World");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(OutputFile, LeavesNothingBehindWhenAbandonedAndKeepsWhatWasThere) {
    const test::TemporaryFolder folder;
    const std::string name = folder.file("scan.ply");
    {
        auto first = OutputFile::create(name);
        ASSERT_TRUE(first && first->write(bytes("old")) && first->finish());
    }
    {
        auto second = OutputFile::create(name);
        ASSERT_TRUE(second);
        ASSERT_TRUE(second->write(bytes(std::string(5'000'000, 'x'))));
    }
    EXPECT_EQ(test::contentOf(name), "old");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(OutputFile, SaysWhyItCannot) {
    const test::TemporaryFolder folder;
    for (const std::string& name : {folder.file("no/such/folder.ply"), folder.file("")}) {
        const auto file = OutputFile::create(name);
        ASSERT_FALSE(file) << name;
        EXPECT_EQ(file.error().code, ErrorCode::Io);
        EXPECT_NE(file.error().message.find(name), std::string::npos) << file.error().message;
    }
    EXPECT_EQ(folder.entries(), 0u);
}

// /dev/full is the kernel's own full disk.
TEST(OutputFile, ReportsAFullDisk) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
    auto file = OutputFile::create("/dev/full");
    ASSERT_TRUE(file);
    EXPECT_FALSE(file->seekable());
    const auto written = file->write(bytes(std::string(3'000'000, 'x')));
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().message.find("No space left"), std::string::npos) << written.error().message;
}

}  // namespace
}  // namespace scancast
