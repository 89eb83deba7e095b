// scancast-client as people run it: arguments in, files and sentences out.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "protocol/json_text.hpp"
#include "protocol/problem.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/client/fake_session.hpp"

namespace scancast::client {
namespace {

struct Outcome {
    int exitCode = -1;
    std::string output;  ///< standard output and standard error
};

Outcome run(const std::string& arguments) {
    const auto command = "timeout 60 '" SCANCAST_BIN_DIR "/scancast-client' " + arguments + " 2>&1";
    auto* pipe = popen(command.c_str(), "r");
    Outcome outcome;
    if (!pipe) return outcome;
    char piece[4096];
    for (std::size_t n = 0; (n = fread(piece, 1, sizeof piece, pipe)) > 0;) outcome.output.append(piece, n);
    const int status = pclose(pipe);
    outcome.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
}

class Program : public testing::Test {
  protected:
    const scancast::test::TemporaryFolder folder_;
};

TEST_F(Program, HelpHasExamplesAndEveryFlag) {
    const auto help = run("--help");
    EXPECT_EQ(help.exitCode, 0);
    for (const auto* name : {"snapshot", "orbit", "info", "bench", "path", "view", "http://127.0.0.1:8080/"})
        EXPECT_NE(help.output.find(name), std::string::npos) << name;
    for (const auto* command : {"snapshot", "orbit"}) {
        const auto text = run(std::string(command) + " --help").output;
        for (const auto* flag : {"--eye", "--view-height", "--param NAME=VALUE", "--subsampling", "Example"})
            EXPECT_NE(text.find(flag), std::string::npos) << command << " " << flag;
    }
    EXPECT_NE(run("").exitCode, 0);
    EXPECT_NE(run("snapshot").exitCode, 0);
}

TEST_F(Program, SnapshotWritesThePicture) {
    auto script = test::fakeLists();
    script.answers["/api/v1/clouds/town/snapshot.jpg"] = {200, "image/jpeg", "\xFF\xD8\xFF!", "\"e\""};
    const test::FakeServer fake(script);
    const auto file = folder_ / "a.jpg";
    const auto outcome = run("snapshot --eye -1,2,3 --param sizePx=5 --param smooth=true " + fake.text() +
                             " --color '#ff8800' -o " + file.string());
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_EQ(scancast::test::contentOf(file), "\xFF\xD8\xFF!");
    EXPECT_TRUE(fake.requests().back().starts_with(
        "GET /api/v1/clouds/town/snapshot.jpg?eye=-1,2,3&color=%23ff8800&param.sizePx=5&param.smooth=true "))
        << fake.requests().back();
}

/// Behind the URL or behind --cloud: every subcommand asks for the one that is named.
TEST_F(Program, EverySubcommandTakesTheCloudInBothWays) {
    const test::FakeServer fake(test::fakeLists());
    const auto at = [&](const char* name) { return (folder_ / name).string(); };
    std::ofstream(folder_ / "flight.json")
        << R"({"keys": [{"time": 0, "camera": {"eye": [0, -50, 20], "target": [0, 0, 0]}}]})";
    // What stands before the cloud, and what stands behind it.
    const std::tuple<std::string, std::string, std::string> commands[] = {
        {"info", "", ""},
        {"snapshot", "", "-o " + at("a.png")},
        {"orbit", "", "--frames 2 -o " + at("frames")},
        {"path", at("flight.json"), "-o " + at("flight")},
        {"bench", "", "--moving 1 --seconds 0.1"},
        {"pick", "", "--x 1 --y 2"},
        {"points", "", "-o " + at("a.las")},
        {"profile", "", "--line '0,0;1,1' -o " + at("a.csv")},
        {"measure", "distance", "--point 0,0,0 --point 3,4,0"},
        {"map", "", "--bbox 0,0,1,1 --width 8 --height 8 -o " + at("a.png")},
        {"lonlat", "", "--point 0,0"},
        {"dem", "", "--cell 1 -o " + at("a.tif")},
        {"ortho", "", "--cell 1 -o " + at("a.tif")}};
    for (const auto& [name, before, behind] : commands) {
        const std::string start = name + " " + fake.text() + " " + before;
        for (const std::string& words :
             {" castle " + behind, " " + behind + " castle", " --cloud castle " + behind}) {
            const auto outcome = run(start + words);
            EXPECT_EQ(outcome.exitCode, 1) << name << words << ": " << outcome.output;
            EXPECT_NE(fake.requests().back().find("/clouds/castle"), std::string::npos)
                << name << words << ": " << fake.requests().back();
        }
        EXPECT_EQ(run(start + " castle --cloud town " + behind).exitCode, 2) << name;
    }
    for (const char* name : {"info", "snapshot", "orbit", "path", "bench", "pick", "points", "profile",
                             "measure", "map", "lonlat", "dem", "ortho", "view"}) {
        const auto help = run(std::string(name) + " --help").output;
        for (const char* word : {"CLOUD ID", "--cloud ID", "with the flag or without", "Example"})
            EXPECT_NE(help.find(word), std::string::npos) << name << ": " << word;
    }
    const auto both = run("path " + fake.text() + " --project tour.json castle -o " + at("flight"));
    EXPECT_NE(both.output.find("if castle is a cloud, say --cloud castle"), std::string::npos) << both.output;
}

TEST_F(Program, ErrorsAreSentencesAndExitCodeOne) {
    const auto nobody = "http://" + test::nobodysUrl().authority();
    for (const auto& [arguments, sentence] : std::vector<std::pair<std::string, std::string>>{
             {"info " + nobody, "start one with `scancast serve FILE`"},
             {"info nonsense", "write something like http://127.0.0.1:8080/"},
             {"info https://localhost/ --ca-file /no/such.pem", "/no/such.pem"},
             {"info http://localhost/ --token-file /no/such.token", "/no/such.token"},
             {"info " + nobody + "/#guest=scg1.a --token-file /no/such.token", "give the one or the other"},
             {"info " + nobody + "/#guest=scg1.a", "start one with `scancast serve FILE`"}}) {
        const auto outcome = run(arguments);
        EXPECT_EQ(outcome.exitCode, 1) << arguments << ": " << outcome.output;
        EXPECT_TRUE(outcome.output.starts_with("scancast-client: ")) << outcome.output;
        EXPECT_NE(outcome.output.find(sentence), std::string::npos) << outcome.output;
    }
}

TEST_F(Program, AWrongCommandLineExitsWithTwo) {
    const auto nobody = "http://" + test::nobodysUrl().authority();
    for (const auto& [arguments, sentence] : std::vector<std::pair<std::string, std::string>>{
             {"", "subcommand"},
             {"info", "URL"},
             {"snapshot " + nobody + " -o picture.bmp", "does not end in .jpg or .png"},
             {"orbit " + nobody + " -o turn.gif", ".gif cannot be written"},
             {"snapshot " + nobody + " --fov wide -o a.jpg", "fov"},
             {"snapshot " + nobody + " --param size -o a.jpg", "NAME=VALUE"}}) {
        const auto outcome = run(arguments);
        EXPECT_EQ(outcome.exitCode, 2) << arguments << ": " << outcome.output;
        EXPECT_NE(outcome.output.find(sentence), std::string::npos) << outcome.output;
    }
}

TEST_F(Program, UnwritableOutputIsNamed) {
    auto script = test::fakeLists();
    script.answers["/api/v1/clouds/town/snapshot.jpg"] = {200, "image/jpeg", "\xFF\xD8\xFF!", ""};
    const test::FakeServer fake(script);
    const auto outcome =
        run("snapshot " + fake.text() + " -o " + (folder_ / "no" / "such" / "a.jpg").string());
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_NE(outcome.output.find("Cannot create " + folder_.path().string()), std::string::npos)
        << outcome.output;
}

TEST_F(Program, NothingThatAServerSaysIsACommandToTheTerminal) {
    const std::string hostile = "\x1b[2J\x1b]0;owned\x07\r\xC2\x9B" + std::string("2J");
    const auto harmless = [&](const Outcome& outcome) {
        EXPECT_EQ(outcome.output.find_first_of("\x1b\x07\r"), std::string::npos) << outcome.output;
        EXPECT_EQ(outcome.output.find("\xC2\x9B"), std::string::npos);
        return outcome.output;
    };
    auto cloud = test::fakeCloud();
    cloud.title = cloud.format = cloud.attributes[0].name = hostile;
    auto method = test::fakeMethod();
    method.title = method.summary = method.parameters[0].meaning = method.parameters[0].unit = hostile;
    auto script = test::fakeLists();
    script.answers["/api/v1/clouds"].body = printJson(toJson(std::vector{cloud}));
    script.answers["/api/v1/methods"].body = printJson(toJson(std::vector{method}));
    script.answers["/api/v1/clouds/town/snapshot.jpg"] = {
        422, "application/problem+json",
        printJson(toJson(problemOf({ErrorCode::ImpossibleView, "because" + hostile, {}}))), ""};
    script.answers["/api/v1/clouds/town/snapshot.png"] = {200, "image/png", "\x89PNG\r\n\x1A\n!",
                                                          "\"e\xC2\x9B\""};
    const test::FakeServer fake(script);
    const auto text = harmless(run("info " + fake.text()));
    EXPECT_NE(text.find("cloud town: ?[2J?]0;owned???2J\n"), std::string::npos) << text;
    const auto json = parseJson(harmless(run("info --json " + fake.text())));
    ASSERT_TRUE(json) << json.error().message;
    EXPECT_EQ(cloudListFromJson(*json)->front().title, hostile) << "escaped, not lost";
    EXPECT_EQ(harmless(run("snapshot " + fake.text() + " -o " + folder_.file("a.jpg"))),
              "scancast-client: because?[2J?]0;owned???2J\n");
    EXPECT_NE(harmless(run("snapshot " + fake.text() + " -o " + folder_.file("a.png"))).find("ETag \"e?\""),
              std::string::npos);
}

TEST_F(Program, NorIsAnArgumentThatIsComplainedOf) {
    const auto outcome = run("info $(printf '%s' '--\x1b[2J') http://localhost/");
    EXPECT_NE(outcome.exitCode, 0);
    EXPECT_NE(outcome.output.find("--?[2J"), std::string::npos) << outcome.output;
}

TEST_F(Program, InfoListsAndPrintsJson) {
    const test::FakeServer fake(test::fakeLists());
    const auto text = run("info " + fake.text());
    EXPECT_EQ(text.exitCode, 0) << text.output;
    EXPECT_NE(text.output.find("cloud town: A town"), std::string::npos) << text.output;
    EXPECT_NE(text.output.find("method point: Points"), std::string::npos) << text.output;
    const auto json = parseJson(run("info --json " + fake.text()).output);
    ASSERT_TRUE(json) << json.error().message;
    EXPECT_EQ(*cloudListFromJson(*json), std::vector{test::fakeCloud()});
    EXPECT_EQ(*methodListFromJson(*json), std::vector{test::fakeMethod()});
}

TEST_F(Program, OrbitWritesOneStillPerStepAllDifferent) {
    auto script = test::fakeLists();
    script.session = test::fakeSession;
    const test::FakeServer fake(script);
    const auto outcome =
        run("orbit " + fake.text() + " --frames 36 --method point -o " + (folder_ / "frames").string());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("36 frames of town"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("frames/s"), std::string::npos) << outcome.output;
    std::set<std::string> pictures;
    for (int i = 1; i <= 36; ++i) {
        const auto name = "frame-0" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ".jpg";
        const auto picture = scancast::test::contentOf(folder_ / "frames" / name);
        EXPECT_TRUE(pictures.insert(picture).second) << name;
        // The fake's pictures are views: complete JSON means a final still, for moving ones have a word
        // behind it.
        const auto view = parseJson(picture);
        ASSERT_TRUE(view) << name << ": " << picture;
        EXPECT_EQ((*view)["method"], "point");
        EXPECT_EQ((*view)["camera"]["target"], nlohmann::json({1.0, 1.0, 1.0}));
    }
}

TEST_F(Program, PathFliesAlongKeyFrames) {
    auto script = test::fakeLists();
    script.session = test::fakeSession;
    const test::FakeServer fake(script);
    const auto file = (folder_ / "flight.json").string();
    std::ofstream(file) << R"({"keys": [{"camera": {"eye": [0, 0, 9]}}, {"camera": {"eye": [8, 0, 9]}}]})";
    const auto outcome = run("path --quiet --fps 4 --method point " + fake.text() + " " + file + " -o " +
                             (folder_ / "frames").string());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    for (int i = 0; i <= 4; ++i) {
        const auto view = parseJson(
            scancast::test::contentOf(folder_ / "frames" / ("frame-00" + std::to_string(i + 1) + ".jpg")));
        ASSERT_TRUE(view) << i;
        EXPECT_EQ((*view)["camera"]["eye"], nlohmann::json({2.0 * i, 0.0, 9.0}));
        EXPECT_EQ((*view)["method"], "point");
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "frames" / "frame-006.jpg"));

    std::ofstream(file) << R"({"keys": [{}, {"camera": {"eey": [8, 0, 9]}}]})";
    const auto refused = run("path " + fake.text() + " " + file + " -o " + folder_.path().string());
    EXPECT_EQ(refused.exitCode, 1);
    EXPECT_NE(refused.output.find("keys[1].camera.eey"), std::string::npos) << refused.output;
    EXPECT_NE(run("path " + fake.text() + " /no/such.json -o x").output.find("/no/such.json"),
              std::string::npos);
}

TEST_F(Program, PathFilmsATourOfAProject) {
    auto script = test::fakeLists();
    script.session = test::fakeSession;
    const test::FakeServer fake(script);
    const auto file = (folder_ / "town.project.json").string();
    const auto write = [&](const std::string& cloud) {
        std::ofstream(file) << R"({"format": "scancast-project", "version": 1, "cloud": {"id": ")" + cloud +
                                   R"("}, "views": [
            {"name": "a", "view": "eye=0,-9,3&target=0,0,3&method=point"}, {"name": "b", "view": "eye=8,-9,3&target=8,0,3&method=disc"}],
            "tours": [{"name": "Walk", "seconds": 1, "pause": 0}]})";
    };
    write("town");
    const std::string command = "path --quiet --fps 4 " + fake.text() + " --project " + file + " -o ";
    const auto outcome = run(command + (folder_ / "frames").string() + " --tour Walk --shading phong");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    double before = -1;
    for (int i = 0; i <= 4; ++i) {
        const auto view = parseJson(
            scancast::test::contentOf(folder_ / "frames" / ("frame-00" + std::to_string(i + 1) + ".jpg")));
        ASSERT_TRUE(view) << i;
        const double x = (*view)["camera"]["eye"][0];
        EXPECT_GT(x, before) << "on its way";
        before = x;
        EXPECT_EQ((*view)["method"], i < 4 ? "point" : "disc");
        EXPECT_EQ((*view)["shading"], "phong");
    }
    EXPECT_EQ(before, 8);
    EXPECT_NE(run(command + "x --tour Flight").output.find("Walk"), std::string::npos);
    EXPECT_NE(run(command + "x --fov 20").output.find("camera of a tour"), std::string::npos);
    EXPECT_NE(run("path " + fake.text() + " -o x").output.find("--project"), std::string::npos);
    EXPECT_NE(run("path " + fake.text() + " flight.json --tour Walk -o x").output.find("--tour"),
              std::string::npos);
    write("elsewhere");
    EXPECT_EQ(run(command + "x").exitCode, 1) << "the project says which cloud";
    EXPECT_TRUE(fake.requests().back().starts_with("GET /api/v1/clouds/elsewhere "))
        << fake.requests().back();
}

TEST_F(Program, BenchMeasuresASessionAndKeepsItsFinalStill) {
    auto script = test::fakeLists();
    script.session = test::fakeSession;
    const test::FakeServer fake(script);
    const auto file = (folder_ / "final.jpg").string();
    const auto outcome = run("bench --json --moving 1 --seconds 0.3 --warm-up 0.1 --method point --final " +
                             file + " " + fake.text() + " 2>" + (folder_ / "phases").string() + " #");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output << scancast::test::contentOf(folder_ / "phases");
    const auto report = parseJson(outcome.output);
    ASSERT_TRUE(report) << outcome.output;
    const auto& group = (*report)["groups"][0];
    EXPECT_EQ(group["behaviour"], "moving");
    EXPECT_EQ(group["failed"], 0);
    EXPECT_EQ(group["finalMs"]["count"], 1);
    // The fake's pictures are the views themselves: what was kept is what was asked for last.
    EXPECT_EQ(scancast::test::contentOf(file), scancast::test::contentOf(file + ".json"));
    EXPECT_NE(scancast::test::contentOf(folder_ / "phases").find("bench: measured"), std::string::npos);
}

TEST_F(Program, BenchWakesIdleSessions) {
    auto script = test::fakeLists();
    script.session = test::fakeSession;
    const test::FakeServer fake(script);
    const auto outcome = run("bench --idle 1 --wake 0.1 --seconds 0.1 --warm-up 0 " + fake.text());
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("0 frames while idle"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("woken: answered"), std::string::npos) << outcome.output;
}

TEST_F(Program, BenchSaysWhatFailed) {
    auto script = test::fakeLists();
    script.session = [](test::FakePeer& peer) { test::welcome(peer); };
    const test::FakeServer fake(script);
    const auto outcome = run("bench --moving 1 --seconds 0.1 --warm-up 0 " + fake.text());
    EXPECT_EQ(outcome.exitCode, 1) << outcome.output;
    EXPECT_NE(outcome.output.find("1 sessions failed"), std::string::npos) << outcome.output;
    EXPECT_NE(run("bench " + fake.text()).output.find("--moving"), std::string::npos);
}

TEST_F(Program, OrbitWhileMovingTakesTheFirstFrame) {
    auto script = test::fakeLists();
    script.session = test::fakeSession;
    const test::FakeServer fake(script);
    const auto outcome = run("orbit --moving --quiet --frames 3 --target 0,0,0 " + fake.text() + " -o " +
                             folder_.path().string());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_TRUE(scancast::test::contentOf(folder_ / "frame-003.jpg").ends_with(" moving"));
    EXPECT_EQ(outcome.output.find("frame 1 of"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace scancast::client
