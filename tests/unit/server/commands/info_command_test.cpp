// `scancast info` as a user calls it, in process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "server/commands/command.hpp"
#include "server/commands/info_print.hpp"
#include "tests/support/clouds/photos_in_memory.hpp"
#include "tests/support/clouds/version_one.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

struct Outcome {
    int exitCode = -1;
    std::string output, errors;
};

/// `words` without the program's name. The command line's own refusals count as exit code 2.
Outcome info(std::vector<std::string> words) {
    words.insert(words.begin(), "info");
    CLI::App app{"scancast"};
    Outcome outcome;
    addInfo(app, outcome.exitCode);
    std::reverse(words.begin(), words.end());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    try {
        app.parse(words);
    } catch (const CLI::ParseError&) {
        outcome.exitCode = 2;
    }
    std::fflush(stdout);
    outcome.output = testing::internal::GetCapturedStdout();
    outcome.errors = testing::internal::GetCapturedStderr();
    return outcome;
}

/// A cloud of 3,000 points whose every fact is set.
class Info : public testing::Test {
  protected:
    Info() : cloud_(test::sampleCloud()), facts_(test::fullFacts(*cloud_, true)) {
        facts_.bounds = cloud_->bounds;
        facts_.classCounts = {};
        facts_.classCounts[2] = 2000;
        facts_.classCounts[6] = 1000;
        facts_.attributes.intensity = true;
        facts_.title = "Hill";
        const auto written = test::writeCloudFile(file(), cloud_->octree, facts_);
        EXPECT_TRUE(written) << written.error().message;
    }
    std::string file() const { return (folder_.path() / "hill.scan").string(); }
    void damage(std::uint64_t at) const {
        std::fstream stream(file(), std::ios::binary | std::ios::in | std::ios::out);
        stream.seekg(std::streamoff(at));
        const char byte = char(stream.get() ^ 1);
        stream.seekp(std::streamoff(at));
        stream.put(byte);
    }

    test::TemporaryFolder folder_;
    std::shared_ptr<const Cloud> cloud_;
    CloudFacts facts_;
};

TEST_F(Info, NothingOfAFileIsACommandToTheTerminal) {
    // A name and a title that clear the screen and name the window.
    const std::string hostile = "\x1b[2J\x1b]0;owned\x07\xC2\x9B" + std::string("2J");
    facts_.title = hostile;
    const std::string name = (folder_.path() / (hostile + ".scan")).string(), missing = name + ".no";
    ASSERT_TRUE(test::writeCloudFile(name, cloud_->octree, facts_));
    const auto told = info({name, missing});
    EXPECT_EQ(told.exitCode, 1);
    EXPECT_THAT(told.output, HasSubstr("title       ?[2J?]0;owned??2J\n"));
    EXPECT_THAT(told.errors, HasSubstr("?[2J?]0;owned??2J.scan.no"));
    const auto asJson = info({"--json", name, missing});
    EXPECT_EQ(json::parse(asJson.output).at("files").at(0).at("title"), hostile) << "escaped, not lost";
    for (const auto& text : {told.output, told.errors, asJson.output, asJson.errors}) {
        EXPECT_THAT(text, Not(HasSubstr("\x1b")));
        EXPECT_THAT(text, Not(HasSubstr("\xC2\x9B")));
    }
}

TEST_F(Info, TellsPeopleWhatIsInACloudFile) {
    const auto told = info({file()});
    EXPECT_EQ(told.exitCode, 0) << told.errors;
    for (const char* words : {"cloud file by scancast ",
                              "Hill",
                              "LAS 1.4, point format 7",
                              "3,000",
                              "bytes a point",
                              "EPSG:2994",
                              "colour, intensity (3 to 65534), classification",
                              "  2 ground",
                              "66.7 %",
                              "  6 building",
                              "33.3 %",
                              "gps_time, float64",
                              "seconds of the week",
                              "return_number, uint8, 1 to 5",
                              "2.7 x 0.1",
                              "levels, ",
                              "yes, normals point to",
                              "All points have the same colour, 0 255 7: that is taken for none.",
                              "town: cloud.js says 5 points.",
                              "Turm, Straße: stood at 0.1429, -389500.1, 0, ",
                              "Scan 2: stood at 4, 5, 6, 0 points"})
        EXPECT_THAT(told.output, HasSubstr(words));
    EXPECT_THAT(told.output, Not(HasSubstr("checked")));
}

// Right because every number is compared with the cloud that was written.
TEST_F(Info, TellsProgramsTheSame) {
    const auto told = info({"--json", file()});
    ASSERT_EQ(told.exitCode, 0) << told.errors;
    const auto all = json::parse(told.output);
    ASSERT_EQ(all.at("files").size(), 1u);
    const json& one = all["files"][0];
    EXPECT_EQ(one.at("kind"), "cloud");
    EXPECT_EQ(one.at("bytes"), std::filesystem::file_size(file()));
    EXPECT_EQ(one.at("points"), 3000);
    EXPECT_EQ(one.at("droppedPoints"), 0xffffffffffffffffull);
    for (std::size_t end = 0; end < 2; ++end)
        for (int a = 0; a < 3; ++a) EXPECT_EQ(one.at("bounds")[end][std::size_t(a)], cloud_->bounds[end][a]);
    EXPECT_EQ(one.at("crs").at("epsg"), 2994);
    EXPECT_EQ(one.at("crs").at("wkt"), facts_.crsWkt);
    EXPECT_EQ(one.at("intensityRange"), (json{3, 65534}));
    EXPECT_EQ(one.at("constant"), json::parse(R"({"color":[0,255,7],"intensity":65535})"));
    EXPECT_EQ(one.at("notes"), json(facts_.notes));
    ASSERT_EQ(one.at("stations").size(), facts_.stations.size());
    EXPECT_EQ(one.at("stations")[0].at("points"), facts_.stations[0].points);
    EXPECT_EQ(one.at("stations")[1].at("name"), "Scan 2") << "it has no name of its own";
    EXPECT_EQ(one.at("stations")[1].at("position"), (json{4.0, 5.0, 6.0}));
    EXPECT_EQ(one.at("classes"), json::parse(R"([{"class":2,"name":"ground","points":2000},
                                                 {"class":6,"name":"building","points":1000}])"));
    EXPECT_EQ(one.at("columns").size(), 3u);
    EXPECT_EQ(one.at("columns")[2].at("range"), (json{-0.25, 31.1}));
    EXPECT_EQ(one.at("mirrors")[0].at("width"), 2.7);
    EXPECT_EQ(one.at("octree").at("nodes"), cloud_->octree.nodes().size());
    EXPECT_EQ(one.at("octree").at("samples"), cloud_->octree.sampleCount());
    EXPECT_EQ(one.at("octree").at("revision"), facts_.revision);
    EXPECT_EQ(one.at("octree").at("surfels"), true);
    EXPECT_EQ(one.at("octree").at("curvature"), false);
    EXPECT_TRUE(one.at("check").is_null());
}

TEST(InfoOfPhotos, TellsThemToPeopleAndToPrograms) {
    FileInfo told;
    told.file = "office.e57";
    told.facts.stations = {{.name = "Tower", .position = {1, 2, 3}}, {.position = {4, 5, 6}}};
    EXPECT_THAT(infoText(told), Not(HasSubstr("photos")));
    EXPECT_EQ(json(infoJson(told)).at("photos"), json::array());
    Photo panorama{
        .name = "All round", .projection = Photo::Projection::Spherical, .width = 8192, .height = 4096};
    panorama.angles = {2 * std::numbers::pi, std::numbers::pi};
    panorama.station = 1;
    panorama.bytes = 5'300'000;
    panorama.pose = Photo::Pose{{4, 5, 6}, {0, 1, 0}, {0, 0, 1}};
    Photo unknown{.format = Photo::Format::Png};
    unknown.bytes = 950;
    unknown.station = 2;  // of a list that was cut
    told.facts.photos = {panorama, unknown};
    const std::string text = infoText(told);
    EXPECT_THAT(
        text, HasSubstr("  photos      All round: spherical jpeg, 8192 x 4096 pixels, 5.30 MB, at Scan 2\n"));
    EXPECT_THAT(text, HasSubstr("              Photo 2: visual png, 950 bytes\n"));
    const json list = json(infoJson(told)).at("photos");
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0],
              json::parse(R"({"name": "All round", "format": "jpeg", "projection": "spherical", "width": 8192,
        "height": 4096, "bytes": 5300000, "anglesAcrossAndDown": [360.0, 180.0], "station": 1, "stationName": "Scan 2",
        "pose": {"position": [4.0, 5.0, 6.0], "forwards": [0.0, 1.0, 0.0], "up": [0.0, 0.0, 1.0]}})"));
    EXPECT_EQ(list[1],
              json::parse(R"({"name": "Photo 2", "format": "png", "projection": "visual", "width": null,
        "height": null, "bytes": 950, "anglesAcrossAndDown": [null, null], "station": null, "stationName": null,
        "pose": null})"));
    told.facts.photos.assign(45, unknown);
    EXPECT_THAT(infoText(told), HasSubstr("Photo 20: visual png"));
    EXPECT_THAT(infoText(told), Not(HasSubstr("Photo 21")));
    EXPECT_THAT(infoText(told), HasSubstr("… and 25 photos more; --json lists them"));
    EXPECT_EQ(json(infoJson(told)).at("photos").size(), 45U);
}

TEST_F(Info, PhotosOfACloudFileAreToldAndCheckedToo) {
    facts_.photos = test::withPhotos(*cloud_)->photos;
    ASSERT_TRUE(test::writeCloudFile(file(), cloud_->octree, facts_));
    EXPECT_THAT(info({file()}).output,
                HasSubstr("All round: spherical jpeg, 400 x 200 pixels, 500 bytes, at Turm, Straße"));
    EXPECT_THAT(info({"--check", file()}).output, HasSubstr("every block is sound"));
    const std::uint64_t offset = CloudFile::open(file()).value()->photoPlaces()[1].offset;
    damage(offset + 100);
    EXPECT_EQ(info({file()}).exitCode, 0) << "it is there, and nobody has looked at it";
    const auto told = info({"--check", file()});
    EXPECT_EQ(told.exitCode, 1);
    EXPECT_THAT(told.output, HasSubstr("1 damaged block;"));
    EXPECT_THAT(told.output, HasSubstr("photo 1"));
    const auto all = json::parse(info({"--check", "--json", file()}).output);
    const json& damaged = all["files"][0].at("check").at("damaged");
    ASSERT_EQ(damaged.size(), 1U);
    EXPECT_EQ(damaged[0].at("photo"), 1);
    EXPECT_TRUE(damaged[0].at("node").is_null());
    EXPECT_EQ(damaged[0].at("offset"), offset);
}

TEST_F(Info, CheckFindsADamagedBlockAndNamesIt) {
    EXPECT_THAT(info({"--check", file()}).output, HasSubstr("every block is sound"));
    const auto place = CloudFile::open(file()).value()->nodes()[3].samples;
    damage(place.offset + 5);
    EXPECT_EQ(info({file()}).exitCode, 0) << "the index is sound";
    const auto told = info({"--check", file()});
    EXPECT_EQ(told.exitCode, 1);
    EXPECT_THAT(told.output, HasSubstr("1 damaged block;"));
    EXPECT_THAT(told.output, HasSubstr("node 3, samples at byte " + std::to_string(place.offset)));
    const auto all = json::parse(info({"--check", "--json", file()}).output);
    const json& check = all["files"][0].at("check");
    EXPECT_EQ(check.at("sound"), false);
    ASSERT_EQ(check.at("damaged").size(), 1u);
    EXPECT_EQ(check.at("damaged")[0].at("node"), 3);
    EXPECT_EQ(check.at("damaged")[0].at("offset"), place.offset);
}

// A plane of a column, one of a companion in an inner node; in version 1, one block of rows.
TEST_F(Info, CheckLooksAtWhatIsBesideTheSamples) {
    const auto sound = CloudFile::open(file()).value();
    const auto leaf = std::uint32_t(sound->nodes().size() - 1);
    damage(sound->planePlace(leaf, 1).offset);
    damage(sound->planePlace(0, 3).offset);
    const auto told = info({"--check", file()});
    EXPECT_EQ(told.exitCode, 1);
    EXPECT_THAT(told.output, HasSubstr("2 damaged blocks;"));
    EXPECT_THAT(told.output, HasSubstr("node " + std::to_string(leaf) + ", plane return_number at byte "));
    EXPECT_THAT(told.output, HasSubstr("node 0, plane density at byte "));

    ASSERT_TRUE(test::writeCloudFile(file(), cloud_->octree, facts_));
    const auto old = test::asVersionOne(*CloudFile::open(file()).value());
    folder_.write("hill.scan", {reinterpret_cast<const char*>(old.data()), old.size()});
    EXPECT_THAT(info({"--check", file()}).output, HasSubstr("every block is sound"));
    damage(CloudFile::open(file()).value()->planePlace(leaf, 1).offset);
    const auto rows = info({"--check", file()});
    EXPECT_THAT(rows.output, HasSubstr("1 damaged block;"));
    EXPECT_THAT(rows.output, HasSubstr("node " + std::to_string(leaf) + ", rows at byte "));
}

TEST_F(Info, WhatCannotBeReadIsAnErrorAndTheRestIsTold) {
    damage(20);
    const auto missing = (folder_.path() / "none.scan").string();
    const auto told = info({missing, file()});
    EXPECT_EQ(told.exitCode, 1);
    EXPECT_THAT(told.errors, HasSubstr("none.scan"));
    EXPECT_THAT(told.errors, HasSubstr("hill.scan, byte 0: the header is damaged"));
    const auto all = json::parse(info({"--json", missing, file()}).output);
    ASSERT_EQ(all.at("files").size(), 2u);
    EXPECT_EQ(all["files"][0].at("error").at("code"), "not-found");
    EXPECT_EQ(all["files"][1].at("error").at("code"), "malformed");
}

TEST_F(Info, AFileThatWasNeverFinishedSaysSo) {
    const auto path = folder_.write("half.scan", std::string(10000, '\0'));
    const auto told = info({path.string()});
    EXPECT_EQ(told.exitCode, 1);
    EXPECT_THAT(told.errors, HasSubstr("never finished"));
}

TEST_F(Info, WithoutAFileItIsUsage) {
    EXPECT_EQ(info({}).exitCode, 2);
}

// autzen_trim.las: 110,000 points, as SOURCES.md beside it says.
TEST(InfoOfAScan, TellsTheHeaderAndWithCheckThePoints) {
    REQUIRE_TEST_DATA("las/autzen_trim.las");
    const auto scan = test::testData("las/autzen_trim.las").string();
    const auto told = info({scan});
    EXPECT_EQ(told.exitCode, 0) << told.errors;
    EXPECT_THAT(told.output, HasSubstr("scan, LAS 1."));
    EXPECT_THAT(told.output, HasSubstr("110,000, as the file declares"));
    EXPECT_THAT(told.output, HasSubstr("gps_time"));
    const auto all = json::parse(info({"--json", "--check", scan}).output);
    const json& one = all["files"][0];
    EXPECT_EQ(one.at("kind"), "scan");
    EXPECT_EQ(one.at("points"), 110000);
    EXPECT_TRUE(one.at("octree").is_null());
    EXPECT_EQ(one.at("check").at("sound"), true);
    std::uint64_t points = 0;
    for (const json& c : one.at("classes")) points += c.at("points").get<std::uint64_t>();
    EXPECT_EQ(points, 110000u) << "every point has a class";
}

// SOURCES.md: every point of it has the intensity 65535.
TEST(InfoOfAScan, WhatIsTheSameEverywhereIsToldOnceItIsRead) {
    REQUIRE_TEST_DATA("las/lonlat-pdrf0.las");
    const auto scan = test::testData("las/lonlat-pdrf0.las").string();
    EXPECT_THAT(info({scan}).output, HasSubstr("attributes  intensity, classification"));
    const auto told = info({"--check", scan});
    EXPECT_THAT(told.output, HasSubstr("attributes  classification\n"));
    EXPECT_THAT(told.output, HasSubstr("All points have the same intensity, 65535"));
}

TEST(InfoOfAScan, CutOffIsAnErrorOnlyWhenRead) {
    REQUIRE_TEST_DATA("las/autzen_trim.las");
    const test::TemporaryFolder folder;
    std::filesystem::copy_file(test::testData("las/autzen_trim.las"), folder.path() / "cut.las");
    std::filesystem::resize_file(folder.path() / "cut.las", 100000);
    const auto told = info({"--check", (folder.path() / "cut.las").string()});
    EXPECT_EQ(told.exitCode, 1);
    EXPECT_THAT(told.errors, HasSubstr("cut.las"));
}

TEST(InfoPage, DescribesEveryFieldOfTheObject) {
    const auto read = [](const char* name) {
        std::ifstream file(std::string(SCANCAST_SOURCE_DIR "/") + name);
        return std::string{std::istreambuf_iterator<char>(file), {}};
    };
    const std::string ownPage = read("docs/info.md"), protocol = read("protocol/PROTOCOL.md");
    FileInfo info;
    info.octree = OctreeInfo{};
    info.checked = true;
    info.damaged = {{}};
    info.facts = test::fullFacts(CloudFacts{}, true);
    info.facts.attributes = {true, true, true, true};
    const auto described = [&](const json& object, const std::string& page, auto&& self) -> void {
        if (object.is_array() && !object.empty()) self(object[0], page, self);
        if (!object.is_object()) return;
        for (const auto& [key, value] : object.items()) {
            EXPECT_THAT(page, HasSubstr("`" + key + "`"));
            // What is in a look is said where the API's is described.
            self(value, key == "look" ? protocol : page, self);
        }
    };
    described(json(infoJson(info)), ownPage, described);
}

}  // namespace
}  // namespace scancast
