#include "protocol/catalog.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sample_views.hpp"

namespace scancast {
namespace {

CloudInfo richCloud() {
    CloudInfo cloud;
    cloud.id = "town";
    cloud.title = "Town";
    cloud.attribution = "Town council, CC BY 4.0";
    cloud.recorded = "2024-05-13";
    cloud.format = "LAS 1.2, point format 3";
    cloud.revision = "abc123";
    cloud.points = 20'000'000'000;
    cloud.droppedPoints = 3;
    cloud.bounds = {glm::dvec3(1, 2, 3), glm::dvec3(4, 5, 6)};
    cloud.origin = {444000, 5412000, 0};
    cloud.spacing = 0.015;
    cloud.attributes = {{"rgb", std::nullopt}, {"intensity", std::array{0.0, 65535.0}}};
    cloud.classes = {2, 6};
    cloud.crsWkt = "PROJCS[\"WGS 84 / UTM zone 33N\"]";
    cloud.crsEpsg = 32633;
    cloud.mirrors = {{{1, 2, 3}, {0, 1, 0}, {0, 0, 1}, 2.5, 1.5, {236, 243, 240}}};
    cloud.columns = {{"gps_time",
                      "float64",
                      "when",
                      {0, 1e6},
                      true,
                      std::array{5.0, 9e5},
                      HistogramInfo{5, 9e5, {1, 0, 20'000'000'000}}},
                     {"user_data", "uint8", "", {0, 0}, false, {}, {}}};
    cloud.bytesResident = 123456789;
    cloud.view = test::richView();
    return cloud;
}

MethodInfo richMethod() {
    return {"cone",
            "Cone",
            "Nice.",
            "Paper",
            {"normal"},
            2,
            Shading::Phong,
            {{"sizePx", "number", 5.0, 1, 50, {}, "px", "Size."},
             {"smooth", "boolean", true, 0, 0, {}, "", "Smooth."},
             {"footprint", "choice", std::string("circle"), 0, 0, {"circle", "square"}, "", "Shape."}}};
}

TEST(Catalog, RoundTrip) {
    const auto cloud = cloudInfoFromJson(toJson(richCloud()));
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(*cloud, richCloud());
    const std::vector<CloudInfo> clouds{richCloud(), CloudInfo{}};
    EXPECT_EQ(*cloudListFromJson(toJson(clouds)), clouds);

    const auto method = methodInfoFromJson(toJson(richMethod()));
    ASSERT_TRUE(method) << method.error().message;
    EXPECT_EQ(*method, richMethod());
    const std::vector<MethodInfo> methods{richMethod(), MethodInfo{}};
    EXPECT_EQ(*methodListFromJson(toJson(methods)), methods);
    EXPECT_TRUE(cloudListFromJson(toJson(std::vector<CloudInfo>{}))->empty());
}

TEST(Catalog, NewMembersAreSkipped) {
    auto object = toJson(richCloud());
    object["weather"] = "fine";
    EXPECT_EQ(*cloudInfoFromJson(object), richCloud());
}

TEST(Catalog, WrongMembersAreNamed) {
    const auto field = [](const char* key, nlohmann::json value) {
        auto object = toJson(std::vector<CloudInfo>{richCloud()});
        object["clouds"][0][key] = std::move(value);
        const auto result = cloudListFromJson(object);
        if (result) return std::string("accepted");
        EXPECT_EQ(result.error().code, ErrorCode::Malformed);
        return result.error().field;
    };
    EXPECT_EQ(field("id", 5), "clouds[0].id");
    EXPECT_EQ(field("points", -1), "clouds[0].points");
    EXPECT_EQ(field("bounds", nlohmann::json::array()), "clouds[0].bounds");
    EXPECT_EQ(field("bounds", {{"min", {1, 2, 3}}}), "clouds[0].bounds.max");
    EXPECT_EQ(field("view", {{"fov", 5}}), "clouds[0].view");
    EXPECT_EQ(field("attributes", {5}), "clouds[0].attributes[0]");
    EXPECT_EQ(field("classes", {500}), "clouds[0].classes");
    for (const auto* text : {"[]", "{}", R"({"clouds": 5})", R"({"clouds": [5]})", R"({"clouds": [{}]})"})
        EXPECT_FALSE(cloudListFromJson(nlohmann::json::parse(text))) << text;
    for (const auto* text :
         {"[]", "{}", R"({"methods": [{}]})", R"({"methods": [{"name": "a", "parameters": [{}]}]})",
          R"({"methods": [{"name": "a", "defaultShading": "soft"}]})"})
        EXPECT_FALSE(methodListFromJson(nlohmann::json::parse(text))) << text;
}

}  // namespace
}  // namespace scancast
