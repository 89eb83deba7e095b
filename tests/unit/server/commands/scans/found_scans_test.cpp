// What arguments stand for, in folders made for it.
#include "server/commands/scans/found_scans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FindScans : public ::testing::Test {
  protected:
    void write(const std::string& name, std::string_view content = "LASF, and what else a header holds") {
        fs::create_directories((folder / name).parent_path());
        folder.write(name, content);
    }
    /// Without the folder's own name; of an error, its message.
    std::vector<std::string> of(std::vector<std::string> arguments, FindScansOptions options = {}) {
        for (auto& argument : arguments) argument = folder.file(argument);
        const auto found = findScans(arguments, options);
        if (!found) return {found.error().message};
        leftOut = found->leftOutText();
        std::vector<std::string> names;
        for (const auto& file : found->files()) names.push_back(file.substr(folder.file("").size()));
        return names;
    }
    test::TemporaryFolder folder;
    std::string leftOut;
};

TEST_F(FindScans, AFolderIsAllScansInItAndBeneathIt) {
    write("f/b.las");
    write("f/a.las");
    write("f/B.LAS");
    write("f/sub/c.laz");
    write("f/a/z.txt", "1 2 3\n4 5 6\n");
    EXPECT_THAT(of({"f"}), ElementsAre("f/B.LAS", "f/a.las", "f/a/z.txt", "f/b.las", "f/sub/c.laz"));
    EXPECT_EQ(leftOut, "");
    EXPECT_THAT(of({"f/"}).front(), "f/B.LAS");
}

TEST_F(FindScans, WhatIsNoScanIsCountedByKind) {
    write("f/a.las");
    write("f/photo.jpg", "\xff\xd8\xff");
    write("f/other.JPG", "\xff\xd8\xff");
    write("f/notes.txt", "Flown on a Monday, in fair weather.\n");
    write("f/README", "1 2 3\n4 5 6\n");  // numbers, but no name that a text of points has
    write("f/a.las.mirrors.json", "{}");  // belongs to a.las
    write("f/.git/config", "");
    fs::create_symlink("nowhere", folder / "f/gone.las");
    ASSERT_EQ(::mkfifo(folder.file("f/pipe.las").c_str(), 0600), 0);
    EXPECT_THAT(of({"f"}), ElementsAre("f/a.las"));
    EXPECT_EQ(leftOut,
              "7 files are no scans: 2 .jpg, 1 .txt, 1 hidden, 1 linked to nowhere, 1 not regular, "
              "1 without an extension");
}

TEST_F(FindScans, AFileWhoseNamePromisesAScanIsOneSoThatItsReaderSaysWhatIsWrong) {
    write("f/a.las");
    write("f/pointer.laz", "version https://git-lfs.github.com/spec/v1\n");
    write("f/empty.ply", "");
    EXPECT_THAT(of({"f"}), ElementsAre("f/a.las", "f/empty.ply", "f/pointer.laz"));
}

TEST_F(FindScans, OctreesOfOtherProgramsAreOneScanEach) {
    write("f/potree/metadata.json", "{}");
    write("f/potree/octree.bin");
    write("f/old/cloud.js", "{}");
    write("f/old/data/r.las");
    write("f/ept/ept.json", "{}");
    write("f/ept/ept-data/0-0-0-0.laz");
    write("f/tiles/metadata.json", "{\"pilot\": \"none\"}");
    write("f/tiles/1.las");
    EXPECT_THAT(of({"f"}), ElementsAre("f/ept", "f/old", "f/potree", "f/tiles/1.las"));
    EXPECT_EQ(leftOut, "1 file is no scan: 1 .json");
    EXPECT_THAT(of({"f/old"}), ElementsAre("f/old"));
    EXPECT_THAT(of({"f/*"}), ElementsAre("f/ept", "f/old", "f/potree", "f/tiles/1.las"));
}

TEST_F(FindScans, CloudFilesOnlyWhereTheyAreWanted) {
    write("f/a.las");
    write("f/all.scan");
    EXPECT_THAT(of({"f"}), ElementsAre("f/a.las", "f/all.scan"));
    EXPECT_THAT(of({"f"}, {.cloudFiles = false}), ElementsAre("f/a.las"));
    EXPECT_EQ(leftOut, "1 file is no scan: 1 .scan (cloud file)");
    EXPECT_THAT(of({"f/all.scan"}, {.cloudFiles = false}), ElementsAre("f/all.scan"));
}

TEST_F(FindScans, PatternsAreExpandedUnlessAFileHasThatName) {
    write("f/1.laz");
    write("f/2.laz");
    write("f/[1].laz");
    write("f/notes.txt", "no points\n");
    EXPECT_THAT(of({"f/*.laz"}), ElementsAre("f/1.laz", "f/2.laz", "f/[1].laz"));
    EXPECT_THAT(of({"f/[1].laz"}), ElementsAre("f/[1].laz"));
    EXPECT_THAT(of({"f/[2].laz"}), ElementsAre("f/2.laz"));
    EXPECT_THAT(of({"f/*"}), ElementsAre("f/1.laz", "f/2.laz", "f/[1].laz"));
    EXPECT_EQ(leftOut, "1 file is no scan: 1 .txt");
    EXPECT_THAT(of({"**/2.*"}), ElementsAre("f/2.laz"));
    EXPECT_THAT(of({"f/**"}), ElementsAre("f/1.laz", "f/2.laz", "f/[1].laz"));
}

TEST_F(FindScans, ArgumentsKeepTheirOrderAndAFileFoundTwiceIsReadOnce) {
    write("f/a.las");
    write("f/b.las");
    write("g/c.las");
    fs::create_symlink(folder / "f/a.las", folder / "g/a-again.las");
    fs::create_hard_link(folder / "g/c.las", folder / "g/d.las");
    EXPECT_THAT(of({"g/c.las", "f"}), ElementsAre("g/c.las", "f/a.las", "f/b.las"));
    EXPECT_THAT(of({"f/b.las", "f", "f/a.las", "f//./a.las"}), ElementsAre("f/b.las", "f/a.las"));
    EXPECT_THAT(of({"f", "g"}), ElementsAre("f/a.las", "f/b.las", "g/c.las"));
    EXPECT_THAT(of({"f/a.las", "f/a.las"}), ElementsAre("f/a.las"));
    // Two names that were both given are meant.
    EXPECT_THAT(of({"f/a.las", "g/a-again.las"}), ElementsAre("f/a.las", "g/a-again.las"));
}

TEST_F(FindScans, LinksOfFoldersAreFollowedAndNoLoopGoneRound) {
    write("disk/a.las");
    write("f/b.las");
    fs::create_directory_symlink(folder / "disk", folder / "f/disk");
    fs::create_directory_symlink(folder / "f", folder / "f/self");
    fs::create_directory_symlink(folder / "f", folder / "disk/back");
    EXPECT_THAT(of({"f"}), ElementsAre("f/b.las", "f/disk/a.las"));
    EXPECT_EQ(leftOut, "");
}

TEST_F(FindScans, WhatHoldsNothingIsAnErrorThatSaysWhatIsThere) {
    fs::create_directory(folder / "empty");
    write("photos/1.jpg", "\xff\xd8\xff");
    EXPECT_THAT(of({"empty"}), ElementsAre(AllOf(HasSubstr("empty"), HasSubstr("no scan in this folder"))));
    EXPECT_THAT(of({"photos"}), ElementsAre(HasSubstr("(1 .jpg)")));
    EXPECT_THAT(of({"photos/*.laz"}), ElementsAre(HasSubstr("no file has such a name")));
    EXPECT_THAT(of({"photos/*"}), ElementsAre(HasSubstr("(1 .jpg)")));
    // Who reads it says that it is not there.
    EXPECT_THAT(of({"none.las"}), ElementsAre("none.las"));
}

TEST_F(FindScans, HasBounds) {
    for (int i = 0; i < 12; ++i) write("f/" + std::to_string(i) + ".las");
    EXPECT_EQ(of({"f"}, {.most = 12}).size(), 12U);
    EXPECT_THAT(of({"f"}, {.most = 11}), ElementsAre(HasSubstr("more than 11 files")));
    std::string deep = "deep";
    for (int i = 0; i < FoundScans::deepest + 5; ++i) deep += "/d";
    write(deep + "/a.las");
    write("deep/b.las");
    EXPECT_THAT(of({"deep"}), ElementsAre("deep/b.las"));
    EXPECT_EQ(leftOut, "1 file is no scan: 1 too deep");
}

}  // namespace
}  // namespace scancast
