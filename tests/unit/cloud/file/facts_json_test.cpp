// Facts are read back as they were written; and facts that are missing, of another type or impossible are
// named.
#include "renderer/cloud/file/facts_json.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>

#include "protocol/json_text.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

/// Of the photos of fullFacts().
const std::vector<BlockPlace> photoPlaces{{std::uint64_t(1) << 50, 23, ~std::uint64_t(0)}, {128, 12, 0}};

nlohmann::json sampleJson() {
    const auto cloud = test::sampleCloud(500);
    return parseJson(printFacts(test::fullFacts(*cloud, true), "me 1.0", photoPlaces).value()).value();
}

TEST(FactsJson, ReadsBackExactly) {
    const auto cloud = test::sampleCloud(500);
    CloudFacts richlyLookedAt = test::fullFacts(*cloud, true);
    richlyLookedAt.look = test::richLook();
    CloudFacts bent;
    bent.companions = {curvaturePlane()};
    bent.usual.emplace().curvature = {-1.0 / 3, 1e9 + 0.1};
    CloudFacts infrared;
    infrared.companions = {curvaturePlane(), nearInfraredPlane()};
    infrared.attributes.nearInfrared = true;
    for (const CloudFacts& facts : {test::fullFacts(*cloud, true), richlyLookedAt, bent, infrared,
                                    static_cast<const CloudFacts&>(*cloud), CloudFacts{}}) {
        const auto places = std::span(photoPlaces).first(facts.photos.size());
        const auto back = parseFacts(printFacts(facts, "me 1.0", places).value());
        ASSERT_TRUE(back) << back.error().message;
        test::expectSameFacts(back->facts, facts);
        EXPECT_TRUE(std::ranges::equal(back->photos, places));
        EXPECT_EQ(back->writtenBy, "me 1.0");
    }
}

// Right because a reader that does not look at a field cannot miss it.
TEST(FactsJson, EveryFieldIsNeededAndOfItsType) {
    const auto json = sampleJson();
    for (const auto& [key, value] : json.items()) {
        auto without = json;
        without.erase(key);
        if (key == "stations") without["photos"][0].erase("station");
        const auto missing = parseFacts(printJson(without));
        const std::set<std::string> rare{"crsEpsg", "constant",    "notes",  "usual",
                                         "scanner", "stations",    "photos", "look",
                                         "grid",    "attribution", "exact",  "recorded"};
        if (rare.contains(key)) {
            EXPECT_TRUE(missing) << "not every scan has one, and older files have no " << key;
        } else {
            ASSERT_FALSE(missing) << key;
            EXPECT_EQ(missing.error().message, "\"" + key + "\" is missing");
        }
        auto wrong = json;
        wrong[key] = value.is_string() ? nlohmann::json(5) : nlohmann::json("five");
        const auto other = parseFacts(printJson(wrong));
        ASSERT_FALSE(other) << key;
        EXPECT_EQ(other.error().code, ErrorCode::Malformed);
        EXPECT_NE(other.error().message.find(key), std::string::npos) << other.error().message;
    }
}

TEST(FactsJson, ImpossibleValuesAreNamed) {
    const std::vector<std::pair<const char*, std::function<void(nlohmann::json&)>>> changes{
        {"bounds", [](auto& j) { j["bounds"][0][0] = 1e300; }},
        {"bounds", [](auto& j) { j["bounds"] = {1, 2, 3, 4, 5, 6}; }},
        {"origin",
         [](auto& j) {
             j["origin"] = {1, 2};
         }},
        {"points", [](auto& j) { j["points"] = -1; }},
        {"points", [](auto& j) { j["points"] = 1.5; }},
        {"intensityRange",
         [](auto& j) {
             j["intensityRange"] = {0, 65536};
         }},
        {"classCounts", [](auto& j) { j["classCounts"]["256"] = 1; }},
        {"classCounts", [](auto& j) { j["classCounts"]["two"] = 1; }},
        {"crsEpsg", [](auto& j) { j["crsEpsg"] = 1ull << 31; }},
        {"spacing", [](auto& j) { j["spacing"] = -0.5; }},
        {"columns.type", [](auto& j) { j["columns"][0]["type"] = "float16"; }},
        {"columns.range",
         [](auto& j) {
             j["columns"][0]["range"] = {2, 1};
         }},
        {"columns",
         [](auto& j) {
             for (int i = 0; i < 2000; ++i) j["columns"].push_back(j["columns"][0]);
         }},
        {"usual.position", [](auto& j) { j["usual"]["position"][1][0] = -1; }},
        {"usual.intensity",
         [](auto& j) {
             j["usual"]["intensity"] = {5, 4};
         }},
        {"usual.brightness",
         [](auto& j) {
             j["usual"]["brightness"] = {0, 1};
         }},
        {"usual.brightness", [](auto& j) { j["usual"].erase("brightness"); }},
        {"grid.step", [](auto& j) { j["grid"]["step"][1] = 0; }},
        {"grid.origin", [](auto& j) { j["grid"].erase("origin"); }},
        {"scanner",
         [](auto& j) {
             j["scanner"] = {1, 2, "3"};
         }},
        {"stations.position",
         [](auto& j) {
             j["stations"][0]["position"] = {1, 2};
         }},
        {"stations.points", [](auto& j) { j["stations"][0]["points"] = -1; }},
        {"stations.name",
         [](auto& j) { j["stations"][1]["name"] = std::string(longestStationName + 1, 'x'); }},
        {"stations.forwards",
         [](auto& j) {
             j["stations"][1]["forwards"] = {1, 1, 1};
         }},
        {"stations",
         [](auto& j) { j["stations"] = std::vector<nlohmann::json>(mostStations + 1, j["stations"][0]); }},
        {"photos.format", [](auto& j) { j["photos"][0]["format"] = "gif"; }},
        {"photos.projection", [](auto& j) { j["photos"][0].erase("projection"); }},
        {"photos.bytes", [](auto& j) { j["photos"][0]["bytes"] = 0; }},
        {"photos.bytes", [](auto& j) { j["photos"][0]["bytes"] = largestPhoto + 1; }},
        {"photos.width", [](auto& j) { j["photos"][1]["width"] = 1ull << 32; }},
        {"photos.offset", [](auto& j) { j["photos"][1]["offset"] = -1; }},
        {"photos.checksum", [](auto& j) { j["photos"][1].erase("checksum"); }},
        {"photos.angles",
         [](auto& j) {
             j["photos"][0]["angles"] = {1, 7};
         }},
        {"photos.station", [](auto& j) { j["photos"][0]["station"] = 2; }},
        {"photos.name", [](auto& j) { j["photos"][0]["name"] = std::string(longestPhotoName + 1, 'x'); }},
        {"photos.pose.up",
         [](auto& j) {
             j["photos"][0]["pose"]["up"] = {0, 0.6, 0.8};
         }},
        {"photos.pose.forwards",
         [](auto& j) {
             j["photos"][0]["pose"]["forwards"] = {0, 1, 1};
         }},
        {"photos",
         [](auto& j) { j["photos"] = std::vector<nlohmann::json>(mostPhotos + 1, j["photos"][1]); }},
        {"look", [](auto& j) { j["look"].erase("views"); }},
        {"look", [](auto& j) { j["look"]["outline"] = nlohmann::json::array(); }},
        {"look", [](auto& j) { j["look"]["views"][0]["camera"]["fov"] = 180; }},
        {"look", [](auto& j) { j["look"]["style"]["shading"] = "dark"; }},
        {"look", [](auto& j) { j["look"]["mood"] = "blue"; }},
        {"planes.type", [](auto& j) { j["planes"][3]["type"] = "float16"; }},
        {"planes.of", [](auto& j) { j["planes"][3]["of"] = "nodes"; }},
        {"planes.name", [](auto& j) { j["planes"][3]["name"] = ""; }},
        {"planes", [](auto& j) { j["planes"].erase(2); }},
        {"planes", [](auto& j) { j["planes"][1]["type"] = "int8"; }},
        {"planes", [](auto& j) { j["planes"][0]["name"] = "time"; }},
        {"planes", [](auto& j) { j["planes"][0]["of"] = "samples"; }},
        {"planes", [](auto& j) { j["planes"].push_back(j["planes"].back()); }},
        {"planes",
         [](auto& j) {
             for (int i = 0; i < 100; ++i) {
                 j["planes"].push_back(j["planes"].back());
                 j["planes"].back()["name"] = std::to_string(i);
             }
         }},
        {"mirrors.normal",
         [](auto& j) {
             j["mirrors"][0]["normal"] = {1, 1, 1};
         }},
        {"mirrors.width", [](auto& j) { j["mirrors"][0]["width"] = 0; }},
        {"mirrors.tint",
         [](auto& j) {
             j["mirrors"][0]["tint"] = {1, 2, 256};
         }},
        {"constant.color",
         [](auto& j) {
             j["constant"]["color"] = {1, 2};
         }},
        {"constant.intensity", [](auto& j) { j["constant"]["intensity"] = 65536; }},
        {"notes", [](auto& j) { j["notes"] = {7}; }},
        {"notes", [](auto& j) { j["notes"] = {std::string(100000, 'x')}; }},
        {"notes", [](auto& j) { j["notes"] = std::vector<std::string>(mostCloudNotes + 1, "x"); }},
        {"attribution", [](auto& j) { j["attribution"] = std::string(513, 'x'); }},
        {"recorded", [](auto& j) { j["recorded"] = "yesterday"; }},
        {"title", [](auto& j) { j["title"] = std::string(100000, 'x'); }},
    };
    for (const auto& [field, change] : changes) {
        auto json = sampleJson();
        change(json);
        const auto facts = parseFacts(printJson(json));
        ASSERT_FALSE(facts) << field;
        EXPECT_TRUE(facts.error().message.starts_with(std::string("\"") + field + "\""))
            << facts.error().message;
    }
}

TEST(FactsJson, VersionOneKnowsNeitherPlanesNorPhotos) {
    auto json = sampleJson();
    const auto passedOver = parseFacts(printJson(json), 1);
    ASSERT_TRUE(passedOver) << passedOver.error().message;
    EXPECT_TRUE(passedOver->facts.companions.empty());
    EXPECT_TRUE(passedOver->facts.photos.empty());
    json.erase("planes");
    EXPECT_TRUE(parseFacts(printJson(json), 1));
    EXPECT_FALSE(parseFacts(printJson(json)));
}

TEST(FactsJson, WhatCannotBeReadIsNotWritten) {
    CloudFacts facts;
    facts.spacing = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(printFacts(facts, "me"));
    facts = {};
    facts.photos = {Photo{}};
    EXPECT_FALSE(printFacts(facts, "me")) << "nobody says where it is";
}

TEST(FactsJson, AColumnWithoutNumbersHasNoRange) {
    CloudFacts facts;
    const double infinity = std::numeric_limits<double>::infinity();
    facts.columns = {{{"empty", ColumnType::Float32, 1, 0, ""}, {infinity, -infinity}}};
    const auto back = parseFacts(printFacts(facts, "me").value());
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->facts.columns[0].range, (std::array<double, 2>{0, 0}));
}

TEST(FactsJson, TextsBecomeUtf8) {
    CloudFacts facts;
    facts.title = "caf\xe9.las";
    const auto back = parseFacts(printFacts(facts, "me").value());
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->facts.title, "caf\ufffd.las");
}

}  // namespace
}  // namespace scancast
