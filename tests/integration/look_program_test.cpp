// `scancast look`, and the looks that `ingest` and `render` are given, as people use them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/look.hpp"
#include "tests/integration/program_fixture.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class LookProgram : public ProgramTest {
  protected:
    void SetUp() override { generate("ball.ply"); }
    /// What `scancast look` prints of it.
    Look lookOf(const std::string& name) {
        std::string out;
        EXPECT_EQ(run({"scancast", "look", file(name)}, &out), 0) << lastError;
        const auto text = parseJson(out);
        EXPECT_TRUE(text) << out;
        if (!text) return {};
        const auto look = applyLook(Look{}, *text);
        EXPECT_TRUE(look) << look.error().message;
        return look.value_or(Look{});
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name) << text;
    }
    void ingest(std::vector<std::string> more = {}) {
        more.insert(more.begin(), {"scancast", "ingest", file("ball.ply"), "-f", "-o", file("ball.scan")});
        ASSERT_EQ(run(more), 0) << lastError;
    }
    std::string rendered(const std::string& name, std::vector<std::string> more = {}) {
        more.insert(more.begin(), {"scancast", "render", file(name), "--backend", "cpu", "--width", "160",
                                   "--height", "90", "-o", file("picture.png")});
        fs::remove(folder / "picture.png");
        EXPECT_EQ(run(more), 0) << lastError;
        return contentOf(file("picture.png"));
    }
};

TEST_F(LookProgram, IsTheSameOfTheScanAndOfItsCloudFile) {
    ingest();
    EXPECT_THAT(lastError, HasSubstr("object, first seen "));
    const Look ofScan = lookOf("ball.ply"), ofFile = lookOf("ball.scan");
    EXPECT_TRUE(validate(ofScan));
    EXPECT_EQ(ofScan, ofFile);
    std::string info;
    ASSERT_EQ(run({"scancast", "info", file("ball.scan")}, &info), 0) << lastError;
    EXPECT_THAT(info, HasSubstr("first seen " + ofFile.views.front().name));
    ASSERT_EQ(run({"scancast", "info", "--json", file("ball.scan")}, &info), 0) << lastError;
    EXPECT_EQ(parseJson(info).value()["files"][0]["look"], toJson(ofFile));
}

TEST_F(LookProgram, TitleAttributionAndDateAreKeptAndChangedInPlace) {
    ingest({"--title", "A ball", "--attribution", "Balls Ltd, CC BY 4.0", "--recorded", "2024-05"});
    const std::string before = rendered("ball.scan");
    std::string out;
    ASSERT_EQ(run({"scancast", "label", file("ball.scan")}, &out), 0) << lastError;
    EXPECT_EQ(out, "title        A ball\nattribution  Balls Ltd, CC BY 4.0\nrecorded     2024-05\n");
    ASSERT_EQ(run({"scancast", "label", file("ball.scan"), "--title", "B", "--recorded", ""}, &out), 0)
        << lastError;
    EXPECT_EQ(out, "title        B\nattribution  Balls Ltd, CC BY 4.0\nrecorded     (not known)\n");
    ASSERT_EQ(run({"scancast", "info", "--json", file("ball.scan")}, &out), 0) << lastError;
    const json info = parseJson(out).value()["files"][0];
    EXPECT_EQ(info["attribution"], "Balls Ltd, CC BY 4.0");
    EXPECT_FALSE(info.contains("recorded"));
    EXPECT_EQ(rendered("ball.scan"), before);

    EXPECT_EQ(run({"scancast", "label", file("ball.scan"), "--recorded", "2023-02-29"}), 2);
    EXPECT_THAT(lastError, HasSubstr("\"2023-02-29\" is no date; write 2024, 2024-05 or 2024-05-13"));
    EXPECT_EQ(run({"scancast", "label", file("ball.scan"), "--attribution", std::string(513, 'x')}), 2);
    EXPECT_THAT(lastError, HasSubstr("the attribution has 513 bytes; it may have 512"));
    EXPECT_EQ(run({"scancast", "ingest", file("ball.ply"), "-o", file("other.scan"), "--recorded", "May"}),
              2);
    EXPECT_THAT(lastError, HasSubstr("\"May\" is no date"));
    EXPECT_EQ(run({"scancast", "label", file("ball.ply"), "--title", "C"}),
              1);  // a scan is nobody's to change
}

TEST_F(LookProgram, IsChangedAndForgotten) {
    ingest();
    const Look decided = lookOf("ball.scan");
    const std::string before = rendered("ball.scan");
    write("change.json", R"({"reason": "I like it so", "style": {"color": "#ff0000", "shading": "unlit"}})");
    ASSERT_EQ(run({"scancast", "look", file("ball.scan"), "--set", file("change.json")}), 0) << lastError;
    EXPECT_THAT(lastError, HasSubstr("from now on"));
    Look wanted = decided;
    wanted.reason = "I like it so";
    wanted.style.color = ColorSource::Flat;
    wanted.style.flatColor = {255, 0, 0};
    wanted.style.shading = Shading::Unlit;
    EXPECT_EQ(lookOf("ball.scan"), wanted);
    const std::string red = rendered("ball.scan");
    EXPECT_FALSE(red == before);
    EXPECT_TRUE(rendered("ball.scan", {"--color", "rgb", "--shading", "unlit"}) != red) << "flags win";
    EXPECT_EQ(run({"scancast", "info", "--check", file("ball.scan")}), 0) << lastError;
    ASSERT_EQ(run({"scancast", "look", file("ball.scan"), "--decide"}), 0) << lastError;
    EXPECT_EQ(lookOf("ball.scan"), decided);
    EXPECT_TRUE(rendered("ball.scan") == before);
}

TEST_F(LookProgram, WhatIsPrintedCanBeSetAgain) {
    ingest();
    std::string out;
    ASSERT_EQ(run({"scancast", "look", file("ball.scan")}, &out), 0) << lastError;
    write("all.json", out);
    const std::string bytes = contentOf(file("ball.scan"));
    ASSERT_EQ(run({"scancast", "look", file("ball.scan"), "--set", file("all.json")}), 0) << lastError;
    std::string again;
    ASSERT_EQ(run({"scancast", "look", file("ball.scan")}, &again), 0) << lastError;
    EXPECT_EQ(again, out);
}

TEST_F(LookProgram, IngestAndRenderTakeOne) {
    write(
        "change.json",
        R"({"views": [{"name": "mine", "inside": true, "camera": {"eye": [9, 0, 1], "target": [0, 0, 0]}}]})");
    ingest({"--look", file("change.json")});
    EXPECT_THAT(lastError, HasSubstr("first seen mine"));
    const Look kept = lookOf("ball.scan");
    ASSERT_EQ(kept.views.size(), 1U);
    EXPECT_EQ(kept.views[0].camera.eye, glm::dvec3(9, 0, 1));
    // Right because one is told of the view by a look, the other has it.
    EXPECT_TRUE(rendered("ball.ply", {"--look", file("change.json")}) == rendered("ball.scan"));
    EXPECT_FALSE(rendered("ball.ply") == rendered("ball.scan"));
}

TEST_F(LookProgram, MistakesAreExplained) {
    ingest({"-q"});
    EXPECT_EQ(lastError, "") << "quiet";
    const std::string bytes = contentOf(file("ball.scan"));
    const auto refused = [&](std::vector<std::string> arguments, const std::string& why) {
        arguments.insert(arguments.begin(), "scancast");
        EXPECT_NE(run(arguments), 0) << why;
        EXPECT_THAT(lastError, HasSubstr(why));
    };
    write("wrong.json", R"({"kind": "a dream"})");
    write("broken.json", "{\"kind\":");
    write("unknown.json", R"({"colour": "red"})");
    write("long.json", std::string(2 << 20, ' '));
    for (const auto& [name, why] : {std::pair{"wrong.json", "airborne"},
                                    {"broken.json", "broken.json"},
                                    {"unknown.json", "colour"},
                                    {"long.json", "too long"},
                                    {"none.json", "none.json"}}) {
        refused({"look", file("ball.scan"), "--set", file(name)}, why);
        refused({"render", file("ball.scan"), "-o", file("a.png"), "--look", file(name)}, why);
        refused({"ingest", file("ball.ply"), "-o", file("other.scan"), "--look", file(name)}, why);
    }
    EXPECT_FALSE(fs::exists(folder / "a.png"));
    EXPECT_FALSE(fs::exists(folder / "other.scan")) << "it is looked at before anything is read";
    refused({"look", file("ball.scan"), "--set", file("wrong.json"), "--decide"}, "--decide");
    refused({"look", file("nowhere.scan")}, "nowhere.scan");
    refused({"look"}, "file");
    write("fine.json", R"({"noise": 0})");
    // A scan has no place where it could be kept.
    refused({"look", file("ball.ply"), "--set", file("fine.json")}, "ball.ply");
    refused({"look", file("ball.ply"), "--decide"}, "ball.ply");
    EXPECT_TRUE(contentOf(file("ball.scan")) == bytes) << "what was refused has changed nothing";
}

TEST_F(LookProgram, AServerShowsIt) {
    ingest();
    const Look look = lookOf("ball.scan");
    const auto server = serve({file("ball.scan"), file("ball.ply"), "--backend", "cpu"});
    for (const char* id : {"ball", "ball-2"}) {
        const std::string cloud = std::string("/api/v1/clouds/") + id;
        auto told = json::parse(request(port, cloud).body);
        auto whole = toJson(look);
        whole.erase("outline");
        EXPECT_EQ(told["look"], whole) << id;
        const auto views = json::parse(request(port, cloud + "/views?width=64&height=36").body)["views"];
        EXPECT_EQ(views.size(), look.views.size());
        // Nothing asked for is the first view, in its style.
        EXPECT_TRUE(request(port, cloud + "/snapshot.png?width=160&height=90").body == rendered("ball.scan"))
            << id;
    }
}

}  // namespace
}  // namespace scancast::test
