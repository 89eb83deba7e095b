// The mirrors' JSON: what is written is read, what is wrong is refused by name.
#include "renderer/cloud/import/mirror_file.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "simulator/scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {

using nlohmann::json;
using ::testing::HasSubstr;

namespace {

json mirror() {
    return {{"center", {1, 2, 3}}, {"normal", {0, -2, 0}}, {"up", {0, 0.5, 0.5}},
            {"width", 1.5},        {"height", 2},          {"tint", "#0a14ff"}};
}

Expected<std::vector<Mirror>> parse(const json& document) {
    return parseMirrors(document.dump(), "a.mirrors.json");
}

void expectMirrorError(const json& document, const char* field, const char* reason) {
    const auto mirrors = parse(document);
    ASSERT_FALSE(mirrors) << document;
    EXPECT_EQ(mirrors.error().code, ErrorCode::Malformed);
    EXPECT_EQ(mirrors.error().field, field) << mirrors.error().message;
    EXPECT_THAT(mirrors.error().message, HasSubstr("a.mirrors.json: "));
    EXPECT_THAT(mirrors.error().message, HasSubstr(reason));
}

/// The document with one field of its second mirror changed.
json with(const char* key, const json& value) {
    json document{{"mirrors", {mirror(), mirror()}}};
    document["mirrors"][1][key] = value;
    return document;
}

}  // namespace

TEST(Mirrors, AreReadAndMadeUnitAndUpright) {
    const auto mirrors = parse({{"mirrors", {mirror()}}});
    ASSERT_TRUE(mirrors) << mirrors.error().message;
    ASSERT_EQ(mirrors->size(), 1U);
    const auto& read = mirrors->front();
    EXPECT_EQ(read.center, glm::dvec3(1, 2, 3));
    EXPECT_EQ(read.normal, glm::dvec3(0, -1, 0));
    EXPECT_LT(glm::distance(read.up, glm::dvec3(0, 0, 1)), 1e-15);
    EXPECT_EQ(read.width, 1.5);
    EXPECT_EQ(read.height, 2);
    EXPECT_EQ(read.tint, (Rgb8{10, 20, 255}));
    auto plain = mirror();
    plain.erase("tint");
    EXPECT_EQ(parse({{"mirrors", {plain}}})->front().tint, (Rgb8{255, 255, 255}));
    EXPECT_TRUE(parse({{"mirrors", json::array()}})->empty());
}

// Round trip with what `scancast generate room` writes: its mirrors go through the same printMirrors().
TEST(Mirrors, OfTheGeneratedRoom) {
    SceneOptions options;
    options.scene = "room";
    options.origin = glm::dvec3(389500.125, 5819800.0625, 34);
    const auto written = sceneMirrors(options);
    ASSERT_FALSE(written.empty());
    const TemporaryFolder folder;
    const auto scan = folder.path() / "room.ply";
    const auto file = folder.write("room.ply.mirrors.json", printMirrors(written));
    EXPECT_EQ(mirrorsFileOf(scan), file);
    const auto read = mirrorsBeside(scan);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), written.size());
    for (std::size_t i = 0; i < written.size(); ++i) {
        EXPECT_EQ((*read)[i].center, written[i].center);
        EXPECT_LT(glm::distance((*read)[i].normal, written[i].normal), 1e-12);
        EXPECT_LT(glm::distance((*read)[i].up, written[i].up), 1e-12);
        EXPECT_EQ((*read)[i].width, written[i].width);
        EXPECT_EQ((*read)[i].height, written[i].height);
        EXPECT_EQ((*read)[i].tint, written[i].tint);
    }
}

TEST(Mirrors, EveryFieldIsChecked) {
    for (const char* key : {"center", "normal", "up"}) {
        const auto field = std::string("mirrors[1].") + key;
        expectMirrorError(with(key, {1, 2}), field.c_str(), "expected an array of 3 numbers");
        expectMirrorError(with(key, {1, 2, "3"}), field.c_str(), "expected an array of 3 numbers");
        expectMirrorError(with(key, nullptr), field.c_str(), "expected an array of 3 numbers");
        expectMirrorError(with(key, {1, 2, 1e300}), field.c_str(), "within -1e15 and 1e15");
    }
    for (const char* key : {"normal", "up"})
        expectMirrorError(with(key, {0, 0, 0}), (std::string("mirrors[1].") + key).c_str(),
                          "must not be zero");
    expectMirrorError(with("up", {0, 7, 0}), "mirrors[1].up", "must not be parallel to normal");
    expectMirrorError(with("up", {0, 7, 1e-9}), "mirrors[1].up", "must not be parallel to normal");
    for (const char* key : {"width", "height"}) {
        const auto field = std::string("mirrors[1].") + key;
        for (const double size : {0.0, -1.0, 1e16})
            expectMirrorError(with(key, size), field.c_str(), "greater than 0");
        expectMirrorError(with(key, "1"), field.c_str(), "expected a number");
    }
    for (const json& tint : {json("red"), json("0a14ff"), json("#0a14f"), json(7)})
        expectMirrorError(with("tint", tint), "mirrors[1].tint", "expected a");
    expectMirrorError(with("widht", 1), "mirrors[1].widht", "widht");
    for (const char* key : {"center", "normal", "up", "width", "height"}) {
        auto incomplete = mirror();
        incomplete.erase(key);
        expectMirrorError({{"mirrors", {incomplete}}}, (std::string("mirrors[0].") + key).c_str(),
                          "is missing");
    }
}

TEST(Mirrors, WholeDocument) {
    expectMirrorError(json::object(), "mirrors", "is missing");
    expectMirrorError({{"mirrors", 1}}, "mirrors", "expected an array");
    expectMirrorError({{"mirrors", {1}}}, "mirrors[0]", "expected an object");
    expectMirrorError({{"mirrors", json::array()}, {"lamps", 1}}, "lamps", "lamps");
    expectMirrorError(json::array(), "", "expected a JSON object");
    EXPECT_EQ(parse({{"mirrors", std::vector<json>(64, mirror())}})->size(), 64U);
    expectMirrorError({{"mirrors", std::vector<json>(65, mirror())}}, "mirrors", "at most 64");
    const auto broken = parseMirrors("{\"mirrors\": [", "a.mirrors.json");
    ASSERT_FALSE(broken);
    EXPECT_THAT(broken.error().message, HasSubstr("a.mirrors.json: "));
    EXPECT_FALSE(parseMirrors("{\"mirrors\": [], \"mirrors\": []}", "twice"));
    EXPECT_FALSE(parseMirrors(R"({"mirrors": [{"center": [1e999, 0, 0]}]})", "infinite"));
}

TEST(Mirrors, Files) {
    const TemporaryFolder folder;
    EXPECT_TRUE(mirrorsBeside(folder.path() / "scan.las")->empty());
    EXPECT_EQ(readMirrors(folder.path() / "no").error().code, ErrorCode::NotFound);
    EXPECT_EQ(readMirrors(folder.path()).error().code, ErrorCode::Unsupported);
    folder.write("bad.las.mirrors.json", "{}");
    const auto bad = mirrorsBeside(folder.path() / "bad.las");
    ASSERT_FALSE(bad);
    EXPECT_THAT(bad.error().message, HasSubstr("bad.las.mirrors.json: mirrors: is missing"));
    const auto large = readMirrors(folder.write("large", std::string((1 << 20) + 1, ' ')));
    ASSERT_FALSE(large);
    EXPECT_THAT(large.error().message, HasSubstr("longer than 1 MiB"));
}

}  // namespace scancast::test
