#include "protocol/points/points_request.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"

namespace scancast {
namespace {

TEST(PointsRequests, EverythingMayBeLeftOut) {
    const auto request = parsePointsRequest("{}");
    ASSERT_TRUE(request) << request.error().message;
    EXPECT_EQ(request->format, PointsFormat::Las);
    EXPECT_TRUE(request->region.isEverything());
    EXPECT_TRUE(
        parsePointsRequest(R"({"region": {"clip": null, "polygon": null, "z": null, "classes": null}})")
            ->region.isEverything());
}

TEST(PointsRequests, WhatIsPrintedIsReadAgain) {
    const std::string text =
        R"({"format": "ply", "normals": true, "region": {"clip": {"min": [0, 0, 0], "max": [10, 10, 5]},
            "clips": [{"plane": {"point": [0, 0, 3], "normal": [0, 0, -1]}}],
            "classes": [2, 6], "polygon": [[0, 0], [1.5, 0], [1, 1]], "z": [-1, 5]}})";
    const auto request = parsePointsRequest(text);
    ASSERT_TRUE(request) << request.error().message;
    EXPECT_EQ(request->format, PointsFormat::Ply);
    EXPECT_EQ(request->region.polygon->size(), 3U);
    EXPECT_EQ(request->region.classes->count(), 2U);
    EXPECT_EQ(request->region.clips.size(), 1U);
    const auto again = parsePointsRequest(printJson(toJson(*request)));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(toJson(*again), toJson(*request));
    EXPECT_EQ(again->region.clip, request->region.clip);

    const auto profile = parseProfileRequest(
        R"({"line": [[0, 0], [5, 5]], "width": 0.5, "format": "png", "region": {"z": [0, 1]},
            "picture": {"width": 320, "height": 200, "exaggeration": 2, "pointSize": 3, "color": "elevation"}})");
    ASSERT_TRUE(profile) << profile.error().message;
    EXPECT_FALSE(profile->format);
    EXPECT_EQ(profile->picture.style.color, ColorSource::Elevation);
    const auto drawn = parseProfileRequest(printJson(toJson(*profile)));
    ASSERT_TRUE(drawn) << drawn.error().message;
    EXPECT_EQ(toJson(*drawn), toJson(*profile));
}

TEST(PointsRequests, APictureIsMeantWhereNothingElseIsNamed) {
    EXPECT_EQ(parseProfileRequest(R"({"line": [[0, 0], [1, 0]]})")->format, PointsFormat::Csv);
    EXPECT_EQ(parseProfileRequest(R"({"line": [[0, 0], [1, 0]]})", true)->format, std::nullopt);
    EXPECT_EQ(parseProfileRequest(R"({"line": [[0, 0], [1, 0]], "format": "las"})", true)->format,
              PointsFormat::Las);
}

TEST(PointsRequests, WhatIsWrongIsNamedByItsPath) {
    const auto wrongPoints = [](const char* text) {
        const auto request = parsePointsRequest(text);
        return request ? "nothing" : request.error().field;
    };
    EXPECT_EQ(wrongPoints(R"({"format": "laz"})"), "format");
    EXPECT_EQ(wrongPoints(R"({"region": 3})"), "region");
    EXPECT_EQ(wrongPoints(R"({"region": {"polygon": [[0, 0], [1, 1]]}})"), "region.polygon");
    EXPECT_EQ(wrongPoints(R"({"region": {"polygon": [[0, 0], [1, 1], ["a", 1]]}})"), "region.polygon");
    EXPECT_EQ(wrongPoints(R"({"region": {"polygon": [[0, -1.7e308], [1, 1.7e308], [2, 0]]}})"),
              "region.polygon");
    EXPECT_EQ(wrongPoints(R"({"region": {"z": [2, 1]}})"), "region.z");
    EXPECT_EQ(wrongPoints(R"({"region": {"clip": {"min": [1, 0, 0], "max": [0, 1, 1]}}})"), "region.clip");
    EXPECT_EQ(wrongPoints(R"({"region": {"classes": [256]}})"), "region.classes");
    EXPECT_EQ(wrongPoints(R"({"region": {"color": "rgb"}})"), "region.color");
    const auto wrongProfile = [](const char* text) {
        const auto request = parseProfileRequest(text);
        return request ? "nothing" : request.error().field;
    };
    EXPECT_EQ(wrongProfile("{}"), "line");
    EXPECT_EQ(wrongProfile(R"({"line": [[0, 0], [0, 0]]})"), "line");
    EXPECT_EQ(wrongProfile(R"({"line": [[0, 0], [1e-305, 0]]})"), "line");
    EXPECT_EQ(wrongProfile(R"({"line": [[0, 0], [1e300, 0]]})"), "line");
    EXPECT_EQ(wrongProfile(R"({"line": [[0, 0], [1, 0]], "width": 0})"), "width");
    EXPECT_EQ(wrongProfile(R"({"line": [[0, 0], [1, 0]], "width": 1e300})"), "width");
    EXPECT_EQ(wrongProfile(R"({"line": [[0, 0], [1, 0]], "picture": {"width": 0}})"), "picture.width");
    EXPECT_EQ(wrongProfile(R"({"line": [[0, 0], [1, 0]], "picture": {"exaggeration": 0}})"),
              "picture.exaggeration");
    EXPECT_EQ(wrongProfile(R"({"line": [[0, 0], [1, 0]], "picture": {"color": "mud"}})"), "picture.color");
}

TEST(PointsRequests, FlagsSayTheSame) {
    const auto places = parsePlanPlaces("1,2;3,4.5;-6,7e1", "polygon");
    ASSERT_TRUE(places) << places.error().message;
    EXPECT_EQ((*places)[2], glm::dvec2(-6, 70));
    EXPECT_FALSE(parsePlanPlaces("1,2;3", "polygon"));
    EXPECT_FALSE(parsePlanPlaces("1,2;;3,4", "polygon"));
    PointsRegion region;
    ASSERT_TRUE(applyRegionWord(region, "clip", "0,0,0,1,1,1"));
    ASSERT_TRUE(applyRegionWord(region, "classes", "2,6"));
    EXPECT_TRUE(region.clip && region.classes->test(6));
    EXPECT_EQ(applyRegionWord(region, "clip", "0,0,0,1,1").error().field, "clip");
    EXPECT_FALSE(parseHeights("3,2"));
}

}  // namespace
}  // namespace scancast
