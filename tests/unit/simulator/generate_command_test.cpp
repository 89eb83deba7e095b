// `scancast generate` as a user calls it, in process.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "files/program_start.hpp"
#include "server/commands/command.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/simulator/scan_file_checker.hpp"

namespace scancast {
namespace {

struct Outcome {
    int exitCode = -1;
    std::string errors;
};

/// `words` without the program's name. CLI11's own refusals count as exit code 2.
Outcome generate(std::vector<std::string> words) {
    words.insert(words.begin(), "generate");
    CLI::App app{"scancast"};
    Outcome outcome;
    addGenerate(app, outcome.exitCode);
    std::reverse(words.begin(), words.end());
    testing::internal::CaptureStderr();
    try {
        app.parse(words);
    } catch (const CLI::ParseError& error) {
        outcome.exitCode = 2;
        std::fputs(error.what(), stderr);
    }
    outcome.errors = testing::internal::GetCapturedStderr();
    return outcome;
}

TEST(Generate, WritesExactlyTheAskedNumberOfPoints) {
    const test::TemporaryFolder folder;
    for (const char* scene :
         {"town", "room", "sphere", "plane", "statue", "cube", "torus", "sign", "bridge"}) {
        if (test::sanitized && scene == std::string("town")) continue;  // SameSeedSameBytes… writes it
        const std::string ply = folder.file("s.ply"), las = folder.file("s.las");
        EXPECT_EQ(generate({scene, "--points", "1.003k", "-o", ply}).exitCode, 0);
        EXPECT_EQ(test::parsePly(test::contentOf(ply)).points.size(), 1003u);
        EXPECT_EQ(generate({scene, "--points", "1_003", "--order", "random", "-o", las}).exitCode, 0);
        EXPECT_EQ(test::parseLas(test::contentOf(las)).points.size(), 1003u);
    }
}

// The promise is bytes, so bytes are compared.
TEST(Generate, SameSeedSameBytesOnAnyNumberOfThreads) {
    const test::TemporaryFolder folder;
    for (const char* order : {"scan", "random"}) {
        std::vector<std::string> files;
        for (const auto& [threads, seed] : {std::pair("1", "7"), {"2", "7"}, {"5", "7"}, {"2", "8"}}) {
            const std::string name = folder.file("t.las");
            ASSERT_EQ(generate({"town", "-n", test::sized("300001", "140001"), "--order", order, "--threads",
                                threads, "--seed", seed, "-o", name, "-q"})
                          .exitCode,
                      0);
            files.push_back(test::contentOf(name));
        }
        EXPECT_TRUE(files[0] == files[1] && files[0] == files[2]) << order;
        EXPECT_FALSE(files[0] == files[3]) << "the seed changes nothing";
    }
}

TEST(Generate, DescribesTheMirrorBesideTheRoom) {
    const test::TemporaryFolder folder;
    ASSERT_EQ(
        generate({"room", "-n", "1000", "--origin", "10,20,30", "-o", folder.file("room.ply")}).exitCode, 0);
    const auto json = nlohmann::json::parse(test::contentOf(folder.file("room.ply.mirrors.json")));
    ASSERT_EQ(json["mirrors"].size(), 1u);
    const auto& mirror = json["mirrors"][0];
    EXPECT_NEAR(mirror["center"][2].get<double>(), 31.45, 1e-9);
    EXPECT_EQ(mirror["normal"].size(), 3u);
    EXPECT_EQ(mirror["tint"].get<std::string>().size(), 7u);
    ASSERT_EQ(generate({"plane", "-n", "1000", "-o", folder.file("plane.ply")}).exitCode, 0);
    EXPECT_FALSE(std::filesystem::exists(folder.file("plane.ply.mirrors.json")));
}

TEST(Generate, RefusesNonsenseInPlainWords) {
    const test::TemporaryFolder folder;
    const std::string name = folder.file("x.ply");
    const auto expectRefusal = [&](std::vector<std::string> words, const char* hint) {
        const Outcome outcome = generate(std::move(words));
        EXPECT_NE(outcome.exitCode, 0) << hint;
        EXPECT_NE(outcome.errors.find(hint), std::string::npos) << outcome.errors;
    };
    expectRefusal({"atlantis", "-o", name},
                  "town, room, sphere, plane, statue, cube, torus, sign and bridge");
    expectRefusal({"town", "-n", "many", "-o", name}, "20M");
    expectRefusal({"town", "-n", "0", "-o", name}, "20M");
    expectRefusal({"town", "-o", folder.file("x.xyz")}, ".ply or .las");
    expectRefusal({"town", "--origin", "1,2", "-o", name}, "X,Y,Z");
    expectRefusal({"town", "--origin", "1,2,nan", "-o", name}, "origin");
    expectRefusal({"town", "--noise", "-1", "-o", name}, "noise");
    expectRefusal({"town", "-n", "10", "-o", folder.file("no/x.ply")}, "the folder is not there");
    expectRefusal({"town", "-n", "200k", "-o", "/dev/full"}, "No space left");
    EXPECT_EQ(folder.entries(), 0u);
}

/// Standard output becomes `descriptor` for as long as this lives.
class StandardOutput {
  public:
    explicit StandardOutput(int descriptor) : saved_(dup(STDOUT_FILENO)) {
        std::fflush(stdout);
        dup2(descriptor, STDOUT_FILENO);
    }
    ~StandardOutput() {
        dup2(saved_, STDOUT_FILENO);
        close(saved_);
    }

  private:
    int saved_;
};

TEST(Generate, WritesToStandardOutput) {
    const test::TemporaryFolder folder;
    const std::string name = folder.file("out");
    const int file = open(name.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0666);
    {
        const StandardOutput redirected(file);
        EXPECT_EQ(generate({"sphere", "-n", "5001", "--format", "las", "-o", "-"}).exitCode, 0);
    }
    close(file);
    const auto scan = test::parseLas(test::contentOf(name));
    EXPECT_EQ(scan.problem, "");
    EXPECT_EQ(scan.points.size(), 5001u);
    for (const glm::dvec3& at : scan.points.position)
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_GE(at[axis], scan.bounds[0][axis]);
            ASSERT_LE(at[axis], scan.bounds[1][axis]);
        }
}

TEST(Generate, ReportsAClosedPipe) {
    startProgram();  // as main() does: the write fails, no signal comes
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    close(ends[0]);
    Outcome outcome;
    {
        const StandardOutput redirected(ends[1]);
        outcome = generate({"sphere", "-n", "200k", "-o", "-"});
    }
    close(ends[1]);
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_NE(outcome.errors.find("reader went away"), std::string::npos) << outcome.errors;
}

}  // namespace
}  // namespace scancast
