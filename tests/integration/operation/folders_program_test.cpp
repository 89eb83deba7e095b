// Folders and patterns in the place of files, as people name them.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include "tests/integration/program_fixture.hpp"

namespace scancast::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class FoldersProgram : public ProgramTest {
  protected:
    void SetUp() override {
        ProgramTest::SetUp();
        fs::create_directories(folder / "flight/day2");
        generate("flight/a.las", "3000");
        generate("flight/day2/b.las", "2000");
        folder.write("flight/photo.jpg", "\xff\xd8\xff");
        folder.write("flight/notes.txt", "Flown on a Monday.\n");
    }
    void generate(const std::string& name, const char* points) {
        ASSERT_EQ(run({"scancast", "generate", "town", "--points", points, "-q", "-o", file(name)}), 0)
            << lastError;
    }
};

// An oracle: the same files, named one by one.
TEST_F(FoldersProgram, IngestOfAFolderIsThatOfItsFiles) {
    ASSERT_EQ(run({"scancast", "ingest", file("flight"), "-o", file("c.scan"), "--title", "x"}), 0)
        << lastError;
    EXPECT_THAT(lastError, AllOf(HasSubstr("5000 points"), HasSubstr("2 files are no scans: 1 .jpg, 1 .txt"),
                                 Not(HasSubstr("photo.jpg"))));
    ASSERT_EQ(run({"scancast", "ingest", file("flight/a.las"), file("flight/day2/b.las"), "-o",
                   file("d.scan"), "--title", "x"}),
              0)
        << lastError;
    EXPECT_TRUE(contentOf(file("c.scan")) == contentOf(file("d.scan")));
    ASSERT_EQ(run({"scancast", "ingest", file("flight/**/*.las"), "-o", file("e.scan"), "--title", "x"}), 0)
        << lastError;
    EXPECT_TRUE(contentOf(file("e.scan")) == contentOf(file("d.scan")));
}

TEST_F(FoldersProgram, TheCloudFileOfAFolderMayLieInItAndEachFileIsNamedOnRequest) {
    for (int i = 0; i < 2; ++i)
        ASSERT_EQ(run({"scancast", "ingest", file("flight/"), "-o", file("flight/all.scan"), "--force",
                       "--verbose"}),
                  0)
            << lastError;
    EXPECT_THAT(lastError, AllOf(HasSubstr("5000 points"), HasSubstr("photo.jpg (.jpg)"),
                                 HasSubstr("all.scan (.scan (cloud file))")));
}

TEST_F(FoldersProgram, InfoRenderAndLookTakeThem) {
    std::string told;
    ASSERT_EQ(run({"scancast", "info", file("flight")}, &told), 0) << lastError;
    EXPECT_THAT(told, AllOf(HasSubstr("a.las"), HasSubstr("day2/b.las")));
    ASSERT_EQ(run({"scancast", "render", file("flight/*"), "--backend", "cpu", "-o", file("a.png"), "--stats",
                   "json"},
                  &told),
              0)
        << lastError;
    EXPECT_THAT(told, HasSubstr("\"points\":5000"));
    ASSERT_EQ(run({"scancast", "look", file("flight")}, &told), 0) << lastError;
    ASSERT_EQ(run({"scancast", "ingest", file("flight"), "-o", file("c.scan")}), 0) << lastError;
    EXPECT_EQ(run({"scancast", "render", file("c.scan"), file("flight/a.las"), "--backend", "cpu", "-o",
                   file("b.png")}),
              1);
    EXPECT_THAT(lastError, HasSubstr("c.scan is a cloud file, and one of several"));
}

TEST_F(FoldersProgram, WhereThereIsNothingIsToldByEachCommand) {
    fs::create_directory(folder / "empty");
    for (const std::string& name : {file("empty"), file("empty/*.laz"), file("none*.las")}) {
        EXPECT_EQ(run({"scancast", "info", name}), 1);
        EXPECT_THAT(lastError, HasSubstr(name));
        EXPECT_EQ(run({"scancast", "ingest", name, "-o", file("c.scan")}), 1);
        EXPECT_THAT(lastError, HasSubstr(name));
        EXPECT_EQ(run({"scancast", "render", name, "-o", file("a.png"), "--backend", "cpu"}), 1);
        EXPECT_THAT(lastError, HasSubstr(name));
        EXPECT_NE(run({"scancast", "serve", name, "--port", "0"}), 0);
        EXPECT_THAT(lastError, HasSubstr(name));
    }
}

TEST_F(FoldersProgram, ServesACloudForEachFile) {
    const auto server = serve({file("flight")});
    EXPECT_EQ(request(port, "/api/v1/clouds/a").status, 200) << server->err();
    EXPECT_EQ(request(port, "/api/v1/clouds/b").status, 200) << server->err();
    EXPECT_THAT(server->err(), HasSubstr("2 files are no scans"));
}

TEST_F(FoldersProgram, ManyFilesNeedFewDescriptors) {
    generate("one.las", "200");
    fs::create_directory(folder / "many");
    for (int i = 0; i < 200; ++i)
        fs::copy_file(file("one.las"), folder / "many" / (std::to_string(i) + ".las"));
    const auto few = [] {
        const rlimit limit{48, 48};
        ::setrlimit(RLIMIT_NOFILE, &limit);
    };
    Process ingest(folder, {"scancast", "ingest", file("many"), "-o", file("c.scan"), "--threads", "2"},
                   "/dev/null", few);
    ASSERT_EQ(ingest.wait(), 0) << ingest.err();
    EXPECT_THAT(ingest.err(), HasSubstr("40000 points"));
    Process render(
        folder,
        {"scancast", "render", file("many"), "-o", file("a.png"), "--backend", "cpu", "--threads", "2"},
        "/dev/null", few);
    EXPECT_EQ(render.wait(), 0) << render.err();
}

}  // namespace
}  // namespace scancast::test
