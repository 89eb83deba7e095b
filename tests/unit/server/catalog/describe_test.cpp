#include "server/catalog/describe.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/support/serving/fake_painter.hpp"

namespace scancast {
namespace {

// Oracle: the protocol's own strict reader gets back what was described.
TEST(Describe, CloudsComeBackThroughTheProtocol) {
    Catalog catalog;
    catalog.setReady(catalog.add("tiny"), test::tinyCloud(3));
    catalog.add("still loading");
    const auto list = cloudListFromJson(cloudListJson(catalog.list()));
    ASSERT_TRUE(list) << list.error().message;
    ASSERT_EQ(list->size(), 1U);
    EXPECT_EQ(list->front().id, "tiny");
    EXPECT_EQ(list->front().points, 3U);
    EXPECT_EQ(list->front().classes, std::vector<std::uint8_t>{2});
    EXPECT_EQ(list->front().bounds[1], glm::dvec3(10, 10, 5));
    EXPECT_GT(list->front().bytesResident, 0U);
}

TEST(Describe, PendingCloudsSayHowFarTheyAre) {
    Catalog catalog;
    const auto id = catalog.add("town");
    catalog.setProgress(id, "reading", 1, 2);
    const auto json = cloudListJson(catalog.list());
    EXPECT_TRUE(json["clouds"].empty());
    EXPECT_EQ(json["pending"][0], (nlohmann::json{{"id", "town"},
                                                  {"title", "town"},
                                                  {"state", "loading"},
                                                  {"stage", "reading"},
                                                  {"progress", 0.5}}));
}

TEST(Describe, ACloudThatIsBeingReadCanBeLookedAtAndSaysHowFarItIs) {
    Catalog catalog;
    const auto id = catalog.add("town");
    catalog.setProgress(id, "sorting", 1, 4);
    auto cloud = std::make_shared<Cloud>(*test::tinyCloud(3));
    cloud->columns = {{{"gps_time", ColumnType::Float64, 1, 0, "GPS time"}, {10, 20}}};
    cloud->attributes.classification = true;
    cloud->classCounts[2] = 3;
    cloud->crsEpsg = 25833;
    cloud->attributes.color = false;
    cloud->constant.color = Rgb8{1, 2, 3};
    cloud->notes = {"cloud.js says 5 points"};
    cloud->mirrors = {{{1, 2, 3}, {0, 1, 0}, {0, 0, 1}, 2, 1, {236, 243, 240}}};
    catalog.setPreview(id, cloud);
    const auto json = cloudListJson(catalog.list());
    EXPECT_TRUE(json["pending"].empty());
    ASSERT_EQ(json["clouds"].size(), 1U);
    const auto& one = json["clouds"][0];
    EXPECT_EQ(one["state"], "loading");
    EXPECT_EQ(one["stage"], "sorting");
    EXPECT_EQ(one["progress"], 0.25);
    EXPECT_EQ(one["columns"][0], (nlohmann::json{{"name", "gps_time"},
                                                 {"type", "float64"},
                                                 {"range", {10.0, 20.0}},
                                                 {"description", "GPS time"},
                                                 {"drawn", true}}));
    EXPECT_EQ(one["classNames"], (nlohmann::json{{"2", "ground"}}));
    EXPECT_EQ(one["classCounts"], (nlohmann::json{{"2", 3}}));
    EXPECT_EQ(one["classColors"], (nlohmann::json{{"2", "#a1794e"}}));
    EXPECT_THAT(one["crsName"].get<std::string>(), testing::HasSubstr("25833"));
    EXPECT_EQ(one["mirrors"][0]["tint"], "#ecf3f0");
    EXPECT_EQ(one["constant"], (nlohmann::json{{"rgb", {1, 2, 3}}}));
    EXPECT_EQ(one["stations"], 0);
    EXPECT_EQ(one["photos"], 0);
    EXPECT_EQ(one["notes"], (nlohmann::json{"cloud.js says 5 points"}));
    EXPECT_EQ(one["attributes"][0]["name"], "intensity") << "the same everywhere is none";
    EXPECT_TRUE(cloudListFromJson(json));
}

TEST(Describe, AFailureSaysWhy) {
    Catalog catalog;
    catalog.setFailed(catalog.add("town"), "town.las ends after 7 bytes");
    const auto json = cloudListJson(catalog.list());
    EXPECT_EQ(json["pending"][0]["state"], "failed");
    EXPECT_EQ(json["pending"][0]["error"], "town.las ends after 7 bytes");
}

TEST(Describe, EveryMethodWithEveryParameter) {
    const auto json = methodListJson();
    const auto list = methodListFromJson(json);
    ASSERT_TRUE(list) << list.error().message;
    ASSERT_EQ(list->size(), methods().size());
    for (std::size_t i = 0; i < list->size(); ++i) {
        EXPECT_EQ((*list)[i].name, methods()[i].name);
        ASSERT_EQ((*list)[i].parameters.size(), methods()[i].parameters.size());
        for (std::size_t p = 0; p < (*list)[i].parameters.size(); ++p) {
            EXPECT_EQ((*list)[i].parameters[p].defaultValue, methods()[i].parameters[p].defaultValue);
            EXPECT_FALSE((*list)[i].parameters[p].meaning.empty());
        }
    }
    EXPECT_EQ(json["colors"],
              nlohmann::json({"auto", "rgb*intensity", "elevation*intensity", "classification*intensity",
                              "cloud*intensity", "rgb", "cir", "intensity", "elevation", "classification",
                              "normal", "curvature", "depth", "lod", "visibility", "cloud"}));
    EXPECT_FALSE(json["colormaps"].empty());
    for (const auto& map : json["colormaps"]) EXPECT_EQ(json["ramps"][map.get<std::string>()].size(), 18U);
    EXPECT_EQ(json["ramps"]["grey"].front(), "#000000");
    EXPECT_EQ(json["ramps"]["grey"][1], "#0f0f0f") << "even steps";
    EXPECT_EQ(json["ramps"]["grey"].back(), "#ffffff");
    EXPECT_EQ(json["ramps"]["viridis"].front(), "#440154");
    EXPECT_TRUE(json["ramps"].contains("curvature"));
    EXPECT_EQ(json["ramps"]["lod"].size(), 10U);
}

}  // namespace
}  // namespace scancast
