// Command lines that are wrong: found out before anything is read or asked for, in a sentence, with one exit code.
#include <gmock/gmock.h>

#include "tests/integration/program_fixture.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;

class CommandLineProgram : public ProgramTest {};

// 2 for a command line that is wrong, in both programs, and before anything is read or asked for: the scan is none, and nobody listens
// at that address.
TEST_F(CommandLineProgram, AWrongCommandLineIsFoundOutAtOnceAndExitsWith2) {
    std::ofstream(folder / "big.las") << "not a scan";
    const std::string nobody = "http://127.0.0.1:1/";
    const std::pair<std::vector<std::string>, const char*> wrong[] = {
        {{"scancast"}, "serve"},
        {{"scancast", "paint"}, "paint"},
        {{"scancast", "render", file("big.las"), "--bogus"}, "--bogus"},
        {{"scancast", "render", file("big.las"), "-o", file("a.png"), "--color", "elevaton"}, "elevation"},
        {{"scancast", "render", file("big.las"), "-o", file("a.png"), "--method", "dics"}, "disc"},
        {{"scancast", "render", file("big.las"), "-o", file("a.png"), "--colormap", "rainbow"}, "viridis"},
        {{"scancast", "render", file("big.las"), "-o", file("a.png"), "--param", "sizePix=3"}, "sizePx"},
        {{"scancast", "render", file("big.las"), "-o", file("a.png"), "--method", "cone", "--param",
          "nonsense=3"},
         "nonsense"},
        {{"scancast", "render", file("big.las"), "-o", file("a.png"), "--light", "ambience=3"},
         "light.ambient"},
        {{"scancast", "render", file("big.las"), "-o", file("a.png"), "--fov", "400"}, "fov"},
        {{"scancast", "render", file("big.las"), "-o", file("a.gif")}, ".png, .jpg or .jpeg"},
        {{"scancast-client"}, "subcommand"},
        {{"scancast-client", "snapshot", nobody}, "--output"},
        {{"scancast-client", "snapshot", nobody, "-o", file("a.jpg"), "--color", "elevaton"}, "elevation"},
        {{"scancast-client", "view", nobody, "--shading", "fog"}, "shading"},
    };
    for (const auto& [words, says] : wrong) {
        EXPECT_EQ(run(words), 2) << words.back() << ": " << lastError;
        EXPECT_THAT(lastError, HasSubstr(says)) << words.back();
    }
    std::string out;
    for (const char* program : {"scancast", "scancast-client"}) {
        EXPECT_EQ(run({program, "--help"}, &out), 0);
        EXPECT_THAT(out, HasSubstr("2 when the command line is wrong")) << program;
    }
}

TEST_F(CommandLineProgram, AFilmThatCannotBeWrittenIsRefusedAndNoFolderMade) {
    for (const char* name : {"turn.gif", "turn.PNG", "turn.mpeg"}) {
        EXPECT_EQ(run({"scancast-client", "orbit", "http://127.0.0.1:1/", "-o", file(name)}), 2) << name;
        EXPECT_THAT(lastError, HasSubstr(".mp4, .mkv, .webm, .mov or .avi")) << name;
        EXPECT_FALSE(fs::exists(folder / name)) << name;
    }
}

TEST_F(CommandLineProgram, AFileThatIsNotThereIsToldBeforeAnyAddress) {
    std::string out;
    EXPECT_EQ(run({"scancast", "serve", "--port", "0", file("nofile.las")}, &out), 1);
    EXPECT_THAT(lastError, HasSubstr("nofile.las"));
    EXPECT_EQ(out, "");
    EXPECT_EQ(run({"scancast", "serve", "--port", "0", file("nofile.las"), file("nothing.ply")}, &out), 1);
    EXPECT_THAT(lastError, HasSubstr("None of the 2 files"));
    EXPECT_EQ(out, "");
}

}  // namespace
}  // namespace scancast::test
