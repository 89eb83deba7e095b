#include "renderer/geo/geo_reference.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace scancast {
namespace {

CloudFacts cloudIn(int epsg) {
    CloudFacts cloud;
    cloud.crsEpsg = epsg;
    return cloud;
}

CloudFacts cloudWith(std::string wkt) {
    CloudFacts cloud;
    cloud.crsWkt = std::move(wkt);
    return cloud;
}

std::string refusalOf(const CloudFacts& cloud) {
    const auto geo = GeoReference::create(cloud);
    EXPECT_FALSE(geo);
    if (geo) return {};
    EXPECT_EQ(geo.error().code, ErrorCode::Unsupported);
    return geo.error().message;
}

// Right because on the middle meridian of a zone, and on the equator, there is nothing to compute; and because web mercator is an explicit
// function of longitude and latitude.
TEST(GeoReference, FollowsFormulas) {
    const auto geo = GeoReference::create(cloudIn(32633));
    ASSERT_TRUE(geo) << geo.error().message;
    EXPECT_EQ(geo->file().epsg, 32633);
    EXPECT_FALSE(geo->file().northFirst);
    EXPECT_EQ(geo->file().metresPerUnit, 1);
    std::vector<glm::dvec2> places{{500000, 0}, {500000, 5800000}, {389500, 5819800}, {700000, 100000}};
    auto degrees = places, metres = places;
    geo->fromFile(WorldCrs::LonLat, degrees);
    geo->fromFile(WorldCrs::WebMercator, metres);
    EXPECT_NEAR(degrees[0].x, 15, 1e-12);
    EXPECT_NEAR(degrees[0].y, 0, 1e-12);
    EXPECT_NEAR(degrees[1].x, 15, 1e-12);
    for (std::size_t i = 0; i < places.size(); ++i) {
        constexpr double radius = 6378137, degree = std::numbers::pi / 180;
        EXPECT_NEAR(metres[i].x, radius * degrees[i].x * degree, 1e-6);
        EXPECT_NEAR(metres[i].y,
                    radius * std::log(std::tan(std::numbers::pi / 4 + degrees[i].y * degree / 2)), 1e-6);
    }
    geo->toFile(WorldCrs::LonLat, degrees);
    geo->toFile(WorldCrs::WebMercator, metres);
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (const glm::dvec2& back : {degrees[i], metres[i]}) {
            EXPECT_NEAR(back.x, places[i].x, 1e-5);
            EXPECT_NEAR(back.y, places[i].y, 1e-5);
        }
    }
}

TEST(GeoReference, OfCompoundSystemsIsTheirPlan) {
    const auto geo = GeoReference::create(cloudIn(7415));  // Amersfoort / RD New + NAP height
    ASSERT_TRUE(geo) << geo.error().message;
    EXPECT_EQ(geo->file().epsg, 28992);
}

TEST(GeoReference, KnowsUnitsAndAxes) {
    const auto feet = GeoReference::create(cloudIn(2263));
    ASSERT_TRUE(feet);
    EXPECT_NEAR(feet->file().metresPerUnit, 1200.0 / 3937, 1e-9);
    const auto northFirst = GeoReference::create(cloudIn(31468));
    ASSERT_TRUE(northFirst);
    EXPECT_TRUE(northFirst->file().northFirst);
    // Around a pole both axes lead the same way: easting first, northing first.
    for (const auto& [polar, isNorthFirst] :
         {std::pair{3031, false}, {5041, false}, {3413, false}, {32661, true}}) {
        const auto around = GeoReference::create(cloudIn(polar));
        ASSERT_TRUE(around) << around.error().message;
        EXPECT_EQ(around->file().northFirst, isNorthFirst) << polar;
    }
    const auto degrees = GeoReference::create(cloudIn(4326));
    ASSERT_TRUE(degrees);
    EXPECT_TRUE(degrees->file().degrees && degrees->file().northFirst);
    std::vector<glm::dvec2> place{{13.4, 52.5}};
    degrees->fromFile(WorldCrs::LonLat, place);
    EXPECT_NEAR(place[0].x, 13.4, 1e-12);
}

TEST(GeoReference, FindsTheNumberOfAWellKnownText) {
    const auto geo = GeoReference::create(cloudWith(
        R"(PROJCS["NAD_1983_UTM_Zone_10N",GEOGCS["GCS_North_American_1983",DATUM["D_North_American_1983",SPHEROID["GRS_1980",6378137.0,298.257222101]],)"
        R"(PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],)"
        R"(PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",-123.0],PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],)"
        R"(UNIT["Meter",1.0]])"));
    ASSERT_TRUE(geo) << geo.error().message;
    EXPECT_EQ(geo->file().epsg, 26910);
    std::vector<glm::dvec2> place{{500000, 0}};
    geo->fromFile(WorldCrs::LonLat, place);
    EXPECT_NEAR(place[0].x, -123, 1e-4);
}

TEST(GeoReference, SaysWhyNot) {
    EXPECT_THAT(refusalOf(CloudFacts{}),
                testing::HasSubstr("says nothing of its coordinate reference system"));
    EXPECT_THAT(refusalOf(cloudIn(4978)), testing::HasSubstr("Where this cloud lies"));
    EXPECT_THAT(refusalOf(cloudWith(R"(LOCAL_CS["site grid",UNIT["metre",1]])")),
                testing::HasSubstr("local"));
    refusalOf(cloudWith("PROJCS[\"cut"));
    refusalOf(cloudIn(7));  // no number of a system
}

TEST(GeoReference, PlacesThatAreNowhereBecomeInfinite) {
    const auto geo = GeoReference::create(cloudIn(32633));
    ASSERT_TRUE(geo);
    std::vector<glm::dvec2> places{{1e300, 0}, {500000, 0}};
    geo->fromFile(WorldCrs::LonLat, places);
    EXPECT_TRUE(std::isinf(places[0].x) && std::isinf(places[0].y));
    EXPECT_NEAR(places[1].x, 15, 1e-9);
}

}  // namespace
}  // namespace scancast
