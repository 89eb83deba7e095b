#include "server/net/api/picture_request.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/view/view_json.hpp"
#include "server/catalog/visible_clouds.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t maxPixels = 1000 * 1000;

std::string formatFor(const std::string& accept, Route route = Route::Snapshot) {
    HttpRequest request{"POST", "/", {}};
    if (!accept.empty()) request.headers.emplace_back("accept", accept);
    const auto format = requestedFormat(request, route);
    return format ? std::string(mediaType(*format)) : std::to_string(format.error().status);
}

TEST(PictureRequest, AcceptChoosesTheFormat) {
    EXPECT_EQ(formatFor(""), "image/jpeg");
    EXPECT_EQ(formatFor("*/*"), "image/jpeg");
    EXPECT_EQ(formatFor("image/*"), "image/jpeg");
    EXPECT_EQ(formatFor("image/png"), "image/png");
    EXPECT_EQ(formatFor("image/png, image/jpeg;q=0.5"), "image/png");
    EXPECT_EQ(formatFor("image/avif, image/webp, image/png;q=0.8, image/jpeg;q=0.7"), "image/png");
    EXPECT_EQ(formatFor("image/jpeg;q=0, */*"), "image/png");
    EXPECT_EQ(formatFor("application/octet-stream"), "application/octet-stream");
    EXPECT_EQ(formatFor("text/html"), "406");
    EXPECT_EQ(formatFor("image/*;q=0"), "406");
}

TEST(PictureRequest, APathThatEndsInAFormatHasThatOne) {
    EXPECT_EQ(formatFor("image/png, */*;q=0.1", Route::SnapshotJpeg), "image/jpeg");
    EXPECT_EQ(formatFor("image/jpeg", Route::SnapshotPng), "406");
}

TEST(PictureRequest, BodiesAreJsonAndSaySo) {
    const auto status = [](const char* type) {
        const HttpRequest request{"POST", "/", {{"content-type", type}}};
        const auto checked = checkJsonBody(request);
        return checked ? 200 : checked.error().status;
    };
    EXPECT_EQ(status("application/json"), 200);
    EXPECT_EQ(status("Application/JSON ; charset=utf-8"), 200);
    for (const char* other : {"", "text/plain", "application/x-www-form-urlencoded", "application/jsonp"})
        EXPECT_EQ(status(other), 415) << other;
}

/// A catalog of one cloud, and whoever sees it all.
struct OneCloud {
    Catalog catalog;
    const std::string id = catalog.add("tiny");
    const VisibleClouds clouds{catalog};

    OneCloud() { catalog.setReady(id, test::tinyCloud()); }
};

TEST(PictureRequest, QueryAndJsonMeanTheSame) {
    const OneCloud one;
    const auto byWords =
        viewOfQuery(one.clouds, one.id, "width=300&height=200&eye=1,2,3&method=cone", maxPixels);
    const auto byJson = viewOfJson(
        one.clouds, one.id,
        parseJson(R"({"width":300,"height":200,"camera":{"eye":[1,2,3]},"method":"cone"})").value(),
        maxPixels);
    ASSERT_TRUE(byWords && byJson);
    EXPECT_EQ(toJson(byWords->planned->view), toJson(byJson->planned->view));
    EXPECT_EQ(toJson(viewOfQuery(one.clouds, one.id, "", maxPixels)->planned->view),
              toJson(viewOfJson(one.clouds, one.id, nlohmann::json::object(), maxPixels)->planned->view));
}

TEST(PictureRequest, WrongViewsAreRefusedByName) {
    const OneCloud one;
    const std::tuple<const char*, ErrorCode, const char*> wrong[] = {
        {R"({"fvo":3})", ErrorCode::InvalidArgument, "fvo"},
        {R"({"camera":{"fvo":3}})", ErrorCode::InvalidArgument, "camera.fvo"},
        {R"({"width":"x"})", ErrorCode::InvalidArgument, "width"},
        {R"({"width":0})", ErrorCode::InvalidArgument, "width"},
        {R"({"width":2000,"height":2000})", ErrorCode::ResourceLimit, "width"},
        {R"({"camera":{"eye":[1,1,1],"target":[1,1,1]}})", ErrorCode::ImpossibleView, ""},
        {R"([])", ErrorCode::InvalidArgument, ""},
    };
    for (const auto& [json, code, field] : wrong) {
        const auto view = viewOfJson(one.clouds, one.id, parseJson(json).value(), maxPixels);
        ASSERT_FALSE(view) << json;
        EXPECT_EQ(view.error().code, code) << json;
        if (*field != '\0') {
            EXPECT_EQ(view.error().field, field) << json;
        }
    }
}

TEST(PictureRequest, DepthDependsOnNoEncoder) {
    View fine;
    fine.quality.jpegQuality = 50;
    fine.quality.samples = 16;
    EXPECT_EQ(depthView(fine), depthView(View()));
    EXPECT_EQ(depthView(fine).quality.samples, 1);
}

}  // namespace
}  // namespace scancast
