#include "files/input_file.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "files/input_folder.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class InputFiles : public ::testing::Test {
  protected:
    void expectRefusal(const fs::path& path, ErrorCode code, const char* reason) const {
        const auto file = InputFile::open(path);
        ASSERT_FALSE(file) << path;
        EXPECT_EQ(name(file.error().code), name(code)) << file.error().message;
        EXPECT_THAT(file.error().message, StartsWith(path.string()));
        EXPECT_THAT(file.error().message, HasSubstr(reason));
    }
    const test::TemporaryFolder folder;
};

TEST_F(InputFiles, AreReadAtAnyPlaceAndAsText) {
    const auto file = InputFile::open(folder.write("a", "0123456789"));
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->bytes(), 10U);
    std::string part(6, '-');
    EXPECT_EQ(file->readAt(7, std::as_writable_bytes(std::span(part))).value(), 3U);
    EXPECT_EQ(part, "789---");
    EXPECT_EQ(file->text(10).value(), "0123456789");
    EXPECT_EQ(file->text(9).error().code, ErrorCode::ResourceLimit);
    std::ofstream(folder / "a", std::ios::app) << std::string(100, 'x');
    EXPECT_EQ(file->text(200)->size(), 110U) << "what was added meanwhile, too";
    EXPECT_EQ(file->text(109).error().code, ErrorCode::ResourceLimit);
    EXPECT_EQ(InputFile::open(folder.write("empty", ""))->text(0).value(), "");
}

TEST_F(InputFiles, AreRegularFilesAndNothingElseAndNobodyWaits) {
    ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
    fs::create_symlink("loop", folder / "loop");
    fs::create_symlink("pipe", folder / "to the pipe");
    expectRefusal(folder / "none", ErrorCode::NotFound, "there is no such file");
    expectRefusal(folder.path(), ErrorCode::Unsupported, "is a folder, not a file");
    expectRefusal(folder / "pipe", ErrorCode::Unsupported, "is a pipe, not a file");
    expectRefusal(folder / "to the pipe", ErrorCode::Unsupported, "is a pipe, not a file");
    expectRefusal("/dev/zero", ErrorCode::Unsupported, "is a device, not a file");
    expectRefusal(folder / "loop", ErrorCode::Io, "cannot be opened: ");
}

// What somebody puts in the place of an open file is never looked at.
TEST_F(InputFiles, TheNameIsAskedOnce) {
    const auto path = folder.write("a", "old");
    const auto file = InputFile::open(path);
    ASSERT_TRUE(file);
    fs::remove(path);
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    const auto shared = file->share();
    ASSERT_TRUE(shared) << shared.error().message;
    EXPECT_EQ(shared->text(100).value(), "old");
    EXPECT_EQ(shared->identity(), file->identity());
}

TEST_F(InputFiles, KnowWhetherTheyAreStillTheSame) {
    const auto path = folder.write("a", "old");
    const auto before = InputFile::open(path)->identity();
    EXPECT_EQ(InputFile::open(path)->identity(), before);
    std::ofstream(path, std::ios::app) << "er";
    EXPECT_NE(InputFile::open(path)->identity(), before);
}

TEST_F(InputFiles, InAFolderNeverLieOutside) {
    fs::create_directories(folder / "root" / "sub");
    folder.write("root/sub/a", "inside");
    folder.write("secret", "outside");
    fs::create_symlink("../secret", folder / "root" / "out");
    const auto root = InputFolder::open(folder / "root");
    ASSERT_TRUE(root) << root.error().message;
    EXPECT_EQ(root->file("sub/a")->text(100).value(), "inside");
    EXPECT_EQ(root->bytes(), 13U);
    EXPECT_TRUE(std::holds_alternative<InputFolder>(*root->at("sub")));
    EXPECT_EQ(root->file("out").error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(root->file("../secret").error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(root->file("none").error().code, ErrorCode::NotFound);
    EXPECT_EQ(root->file("sub").error().code, ErrorCode::Unsupported);
    // The folder that was opened counts, wherever it is by now.
    fs::rename(folder / "root", folder / "moved");
    fs::create_directories(folder / "root" / "sub");
    folder.write("root/sub/a", "another");
    EXPECT_EQ(root->file("sub/a")->text(100).value(), "inside");
    EXPECT_EQ(InputFolder::open(folder / "secret").error().code, ErrorCode::NotFound);
}

}  // namespace
}  // namespace scancast
