// Patterns against names: by what POSIX shells do (a brute-force matcher says the same), and along folders.
#include "server/commands/scans/glob.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Glob, StarsQuestionMarksAndSets) {
    EXPECT_TRUE(matchesName("*.laz", "a.laz"));
    EXPECT_TRUE(matchesName("*.laz", "a.b.laz"));
    EXPECT_FALSE(matchesName("*.laz", "a.lazy"));
    EXPECT_FALSE(matchesName("*.laz", "a.LAZ"));
    EXPECT_TRUE(matchesName("tile_?.las", "tile_7.las"));
    EXPECT_FALSE(matchesName("tile_?.las", "tile_77.las"));
    EXPECT_TRUE(matchesName("tile_[0-4a].las", "tile_3.las"));
    EXPECT_TRUE(matchesName("tile_[0-4a].las", "tile_a.las"));
    EXPECT_FALSE(matchesName("tile_[0-4a].las", "tile_5.las"));
    EXPECT_TRUE(matchesName("[!0-4]", "5"));
    EXPECT_TRUE(matchesName("[^0-4]", "5"));
    EXPECT_FALSE(matchesName("[!0-4]", "4"));
    EXPECT_TRUE(matchesName("[]]", "]"));
    EXPECT_TRUE(matchesName("[a-]", "-"));
    EXPECT_TRUE(matchesName("a[b", "a[b"));  // a set without an end is none
    EXPECT_TRUE(matchesName("a\\*b", "a*b"));
    EXPECT_FALSE(matchesName("a\\*b", "axb"));
    EXPECT_TRUE(matchesName("*", "anything"));
    EXPECT_TRUE(matchesName("**", "anything"));
    EXPECT_TRUE(matchesName("", ""));
    EXPECT_FALSE(matchesName("", "a"));
}

TEST(Glob, CharactersAreThoseOfUtf8AndBytesThatAreNoneMatchThemselves) {
    EXPECT_TRUE(matchesName("?", "ü"));
    EXPECT_TRUE(matchesName("[ä-ü]", "ö"));
    EXPECT_FALSE(matchesName("[ä-ü]", "x"));
    EXPECT_TRUE(matchesName("?", "\xff"));
    EXPECT_TRUE(matchesName("\xff*", "\xff\xfe"));
    EXPECT_TRUE(matchesName("??", "\xc3x"));  // a lead byte without what should follow
}

TEST(Glob, HiddenNamesNeedADot) {
    EXPECT_FALSE(matchesName("*", ".git"));
    EXPECT_FALSE(matchesName("?git", ".git"));
    EXPECT_TRUE(matchesName(".*", ".git"));
    EXPECT_TRUE(matchesName(".g?t", ".git"));
}

TEST(Glob, OnlyWhatHasAStarOrItsLikeIsAPattern) {
    EXPECT_TRUE(isPattern("a*"));
    EXPECT_TRUE(isPattern("a?b/c"));
    EXPECT_TRUE(isPattern("[a]"));
    EXPECT_FALSE(isPattern("flight/town.las"));
    EXPECT_FALSE(isPattern("a\\*"));
}

bool bruteForce(std::string_view pattern, std::string_view name) {
    if (pattern.empty()) return name.empty();
    if (pattern.front() == '*')
        return bruteForce(pattern.substr(1), name) || (!name.empty() && bruteForce(pattern, name.substr(1)));
    return !name.empty() && (pattern.front() == '?' || pattern.front() == name.front()) &&
           bruteForce(pattern.substr(1), name.substr(1));
}

TEST(Glob, SaysWhatTryingEverythingSays) {
    std::mt19937 random(7);
    const auto text = [&](std::string_view letters, std::size_t longest) {
        std::string result(random() % (longest + 1), ' ');
        for (char& c : result) c = letters[random() % letters.size()];
        return result;
    };
    for (int i = 0; i < 20000; ++i) {
        const auto pattern = text("ab*?", 7), name = text("ab", 8);
        ASSERT_EQ(matchesName(pattern, name), bruteForce(pattern, name)) << pattern << ' ' << name;
    }
}

TEST(Glob, ManyStarsEndSoon) {
    std::string pattern;
    for (int i = 0; i < 2000; ++i) pattern += "a*";
    EXPECT_FALSE(matchesName(pattern + "b", std::string(4000, 'a')));
}

class Paths : public ::testing::Test {
  protected:
    void SetUp() override {
        for (const char* one :
             {"b/1.laz", "b/2.las", "a/1.laz", "a/deep/er/3.laz", "a/.hidden/4.laz", "5.laz"}) {
            fs::create_directories((folder / one).parent_path());
            folder.write(one, "");
        }
    }
    std::vector<std::string> of(const std::string& pattern, std::size_t most = 1000) {
        auto paths = pathsOf(folder.file(pattern), most);
        if (!paths) return {paths.error().message};
        for (auto& path : *paths) path.erase(0, folder.file("").size());
        return *paths;
    }
    test::TemporaryFolder folder;
};

TEST_F(Paths, GoThroughFoldersInByteOrder) {
    EXPECT_THAT(of("*.laz"), ElementsAre("5.laz"));
    EXPECT_THAT(of("*/*.laz"), ElementsAre("a/1.laz", "b/1.laz"));
    EXPECT_THAT(of("b/[0-9].la[sz]"), ElementsAre("b/1.laz", "b/2.las"));
    EXPECT_THAT(of("?/"), ElementsAre("a", "b"));
    EXPECT_THAT(of("*/none/*"), IsEmpty());
    EXPECT_THAT(of("*/deep/er/3.laz"), ElementsAre("a/deep/er/3.laz"));
}

TEST_F(Paths, TwoStarsAreAnyNumberOfFolders) {
    EXPECT_THAT(of("**/*.laz"), ElementsAre("5.laz", "a/1.laz", "a/deep/er/3.laz", "b/1.laz"));
    EXPECT_THAT(of("a/**/3.laz"), ElementsAre("a/deep/er/3.laz"));
    EXPECT_THAT(of("**/**/3.laz"), ElementsAre("a/deep/er/3.laz"));
    EXPECT_THAT(of("a/**"), ElementsAre("a"));  // what is in a folder, its reader says
}

TEST_F(Paths, LinksInALoopAreNotGoneRound) {
    fs::create_directory_symlink(folder / "a", folder / "a/deep/again");
    EXPECT_THAT(of("**/3.laz"), ElementsAre("a/deep/er/3.laz"));
}

TEST_F(Paths, HaveABound) {
    ASSERT_EQ(of("**/*.laz", 5).size(), 1U);
    EXPECT_THAT(of("**/*.laz", 5).front(), ::testing::HasSubstr("more than 5 files"));
}

}  // namespace
}  // namespace scancast
