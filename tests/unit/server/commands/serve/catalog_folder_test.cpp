#include "server/commands/serve/catalog_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/clouds/write_cloud.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CatalogFolderTest : public ::testing::Test {
  protected:
    CatalogFolderTest() {
        SyntheticSource source(500, ground, {});
        writeCloud(*build(source), folder / "whole");
        std::ifstream in(folder / "whole", std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(in), {});
        in.close();
        fs::create_directory(folder / "clouds");
    }
    fs::path at(const std::string& name) const { return folder / "clouds" / name; }
    void write(const std::string& name, const std::string& content) const {
        std::ofstream(at(name), std::ios::binary | std::ios::trunc) << content;
    }
    bool look() { return catalog.look(most); }
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const fs::path& file : catalog.files()) names.push_back(file.filename().string());
        return names;
    }

    const TemporaryFolder folder;
    std::string bytes;
    std::vector<std::string> notes;
    CatalogFolder catalog{folder / "clouds", [this](const std::string& note) { notes.push_back(note); }};
    std::size_t most = 3;
};

TEST_F(CatalogFolderTest, CloudsComeAndGo) {
    EXPECT_FALSE(look());
    write("b.scan", bytes);
    write("a.cloud", bytes);
    EXPECT_TRUE(look());
    EXPECT_THAT(names(), ElementsAre("a.cloud", "b.scan"));
    EXPECT_FALSE(look()) << "nothing is new";
    fs::remove(at("a.cloud"));
    EXPECT_TRUE(look());
    EXPECT_THAT(names(), ElementsAre("b.scan"));
    EXPECT_THAT(notes, IsEmpty());
}

TEST_F(CatalogFolderTest, WhatIsHalfWrittenIsNotShown) {
    for (const std::size_t part : {std::size_t(0), std::size_t(7), bytes.size() / 2, bytes.size() - 1}) {
        write("a.scan", bytes.substr(0, part));
        EXPECT_FALSE(look()) << part;
    }
    EXPECT_THAT(notes, ElementsAre(HasSubstr("a.scan is not served until it is whole: ")))
        << "once, however often it has grown";
    write("a.scan", bytes);
    EXPECT_TRUE(look());
    EXPECT_THAT(names(), ElementsAre("a.scan"));
    write("a.scan", bytes.substr(0, 100));
    EXPECT_FALSE(look()) << "what becomes of its content is the watch's to say";
    fs::remove(at("a.scan"));
    EXPECT_TRUE(look());
    write("a.scan", bytes.substr(0, 100));
    EXPECT_FALSE(look()) << "another file has taken the name, and is judged anew";
}

TEST_F(CatalogFolderTest, OnlyCloudFilesThatAreMeantToBeSeen) {
    write(".b.scan", bytes);
    write("notes.txt", "these are notes");
    write("c.scan", "these too");
    fs::create_directory(at("deeper"));
    fs::create_symlink(folder / "whole", at("linked.scan"));
    fs::create_symlink(folder / "nowhere", at("lost.scan"));
    EXPECT_TRUE(look());
    EXPECT_THAT(names(), ElementsAre("linked.scan"));
    EXPECT_THAT(notes, ElementsAre(HasSubstr("c.scan is not served: it is no cloud file")));
}

TEST_F(CatalogFolderTest, WhatCannotBeReadIsToldOnceAndTriedAgain) {
    fs::create_symlink("a.scan", at("a.scan"));  // and not one without permissions, which root may read
    EXPECT_FALSE(look());
    EXPECT_FALSE(look());
    EXPECT_THAT(notes, ElementsAre(HasSubstr("a.scan is not served until it can be read: ")));
    fs::remove(at("a.scan"));
    write("a.scan", bytes);
    EXPECT_TRUE(look());
    EXPECT_THAT(names(), ElementsAre("a.scan"));
}

// That this process has no descriptor left says nothing of the file.
TEST_F(CatalogFolderTest, WhatThereWereNoDescriptorsForIsLookedAtAgain) {
    write("a.scan", bytes);
    write("b.scan", bytes.substr(0, bytes.size() / 2));
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
    const int listing = ::open(at("").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_GE(listing, 0);
    ::close(listing);
    // Room for the listing, which is closed before files are opened; then for a file, and none for sharing it.
    rlimit few = before;
    few.rlim_cur = rlim_t(listing) + 1;
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
    const bool isOther = look();
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
    EXPECT_FALSE(isOther);
    EXPECT_THAT(notes, ElementsAre(HasSubstr("a.scan is not served until it can be read: "),
                                   HasSubstr("b.scan is not served until it can be read: ")));
    EXPECT_TRUE(look());
    EXPECT_THAT(names(), ElementsAre("a.scan"));
    EXPECT_THAT(notes.back(), HasSubstr("b.scan is not served until it is whole: "));
}

TEST_F(CatalogFolderTest, AnIdIsOneFilesWhateverCameFirst) {
    write("a-b.scan", bytes);
    EXPECT_TRUE(look());
    write("a b.scan", bytes);
    EXPECT_TRUE(look());
    EXPECT_THAT(names(), ElementsAre("a b.scan")) << "as on a server that has just started";
    EXPECT_THAT(notes, ElementsAre(HasSubstr("a-b.scan is not served: another file's cloud has the id a-b")));
}

TEST_F(CatalogFolderTest, NoMoreThanMayBe) {
    for (const char* name : {"1.scan", "2.scan", "3.scan", "4.scan", "5.scan"}) write(name, bytes);
    EXPECT_TRUE(look());
    EXPECT_EQ(names().size(), 3U);
    EXPECT_THAT(notes,
                ElementsAre(HasSubstr("2 clouds are not served, because --max-clouds leaves room for 3")));
    most = 1;
    EXPECT_TRUE(look());
    EXPECT_THAT(names(), ElementsAre("1.scan"));
    most = 5;
    EXPECT_TRUE(look());
    EXPECT_EQ(names().size(), 5U);
}

TEST_F(CatalogFolderTest, AFolderThatIsAwayTakesNothingAway) {
    write("a.scan", bytes);
    EXPECT_TRUE(look());
    fs::rename(folder / "clouds", folder / "away");
    EXPECT_FALSE(look());
    EXPECT_FALSE(look());
    EXPECT_THAT(names(), ElementsAre("a.scan"));
    EXPECT_EQ(notes.size(), 1U);
    fs::rename(folder / "away", folder / "clouds");
    EXPECT_FALSE(look());
    EXPECT_THAT(names(), ElementsAre("a.scan"));
}

}  // namespace
}  // namespace scancast::test
