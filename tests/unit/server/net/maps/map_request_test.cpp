#include "server/net/maps/map_request.hpp"

#include <gmock/gmock.h>

#include "server/net/clients/public_url.hpp"
#include "server/net/maps/service_exception.hpp"
#include "server/net/maps/tile_sets.hpp"
#include "server/net/maps/xml_text.hpp"

namespace scancast {
namespace {

constexpr const char* getMap =
    "service=WMS&version=1.3.0&request=GetMap&layers=town&crs=EPSG:25833&bbox=1,2,3,4.5&width=30&height=20";

std::string fieldOf(const std::string& query) {
    const auto parsed = parseWmsRequest(query, "town");
    return parsed ? "" : parsed.error().field;
}

MapRequest mapOf(const std::string& query) {
    const auto parsed = parseWmsRequest(query, "town");
    EXPECT_TRUE(parsed) << parsed.error().message;
    if (!parsed || !std::holds_alternative<MapRequest>(*parsed)) return {};
    return std::get<MapRequest>(*parsed);
}

TEST(MapRequest, NamesComeInAnyCase) {
    const MapRequest map = mapOf(getMap);
    EXPECT_EQ(map.crs, "EPSG:25833");
    EXPECT_EQ(map.box, (std::array<double, 4>{1, 2, 3, 4.5}));
    EXPECT_TRUE(map.axesOfCrs);
    EXPECT_EQ(map.width, 30);
    EXPECT_FALSE(map.transparent);
    EXPECT_EQ(map.background, (Rgb8{255, 255, 255}));
    EXPECT_TRUE(map.words.empty());
    const MapRequest styled = mapOf(
        std::string("&&") + getMap +
        "&Styles=elevation&TRANSPARENT=true&BgColor=0x010203&method=ewa&color=rgb&DPI=96&colormap=turbo");
    EXPECT_EQ(styled.words, (WordValues{{"method", "ewa"}, {"colormap", "turbo"}, {"color", "elevation"}}));
    EXPECT_TRUE(styled.transparent);
    EXPECT_EQ(styled.background, (Rgb8{1, 2, 3}));
}

TEST(MapRequest, OfOldVersionsHasXFirst) {
    const MapRequest map = mapOf(
        "REQUEST=GetMap&SRS=EPSG:4326&BBOX=1,2,3,4&WIDTH=3&HEIGHT=2&FORMAT=image/jpeg&TRANSPARENT=TRUE");
    EXPECT_FALSE(map.axesOfCrs);
    EXPECT_FALSE(map.transparent) << "JPEG is not";
    const auto info = parseWmsRequest(
        "VERSION=1.1.1&REQUEST=GetFeatureInfo&SRS=EPSG:4326&BBOX=1,2,3,4&WIDTH=3&HEIGHT=2&X=2&Y=1", "town");
    ASSERT_TRUE(info) << info.error().message;
    EXPECT_EQ(std::get<FeatureRequest>(*info).i, 2);
}

TEST(MapRequest, LegendsHaveStylesAndWordsOfMaps) {
    const auto parsed = parseWmsRequest(
        "SERVICE=WMS&VERSION=1.3.0&REQUEST=GetLegendGraphic&SLD_VERSION=1.1.0&LAYER=town&STYLE=elevation&"
        "FORMAT="
        "image/png&TRANSPARENT=true&WIDTH=20&HEIGHT=20&SCALE=1000&DPI=96&colormap=turbo",
        "town");
    ASSERT_TRUE(parsed) << parsed.error().message;
    const auto& legend = std::get<LegendRequest>(*parsed);
    EXPECT_EQ(legend.words, (WordValues{{"colormap", "turbo"}, {"color", "elevation"}}));
    EXPECT_TRUE(legend.transparent);
    const std::string ask = "request=GetLegendGraphic";
    EXPECT_EQ(fieldOf(ask), "");
    EXPECT_EQ(fieldOf(ask + "&layer=other"), "LAYER");
    EXPECT_EQ(fieldOf(ask + "&style=gaudy"), "STYLE");
    EXPECT_EQ(fieldOf(ask + "&format=image/gif"), "FORMAT");
    EXPECT_EQ(fieldOf(ask + "&rule=ground"), "RULE");
    EXPECT_EQ(fieldOf(ask + "&sld=http://x/y"), "SLD");
}

TEST(MapRequest, CapabilitiesAreOfAVersionThatIsKnown) {
    for (const auto& [version, isOld] : std::vector<std::pair<std::string, bool>>{{"", false},
                                                                                  {"1.3.0", false},
                                                                                  {"2.0.0", false},
                                                                                  {"1.1.1", true},
                                                                                  {"1.1.0", true},
                                                                                  {"1.0.0", true}}) {
        const auto parsed = parseWmsRequest("REQUEST=GetCapabilities&VERSION=" + version, "town");
        ASSERT_TRUE(parsed);
        EXPECT_EQ(std::get<CapabilitiesRequest>(*parsed).isOld, isOld) << version;
    }
}

TEST(MapRequest, WhatIsWrongIsNamed) {
    const std::string map = getMap;
    EXPECT_EQ(fieldOf(map), "");
    EXPECT_EQ(fieldOf("service=WMTS&request=GetMap"), "SERVICE");
    EXPECT_EQ(fieldOf("request=GetLost"), "REQUEST");
    EXPECT_EQ(fieldOf(map + "&layer=town&Width=3"), "WIDTH");
    EXPECT_EQ(fieldOf(map + "&styles=gaudy"), "STYLES");
    EXPECT_EQ(fieldOf(map + "&format=image/tiff"), "FORMAT");
    EXPECT_EQ(fieldOf(map + "&transparent=perhaps"), "TRANSPARENT");
    EXPECT_EQ(fieldOf(map + "&bgcolor=red"), "BGCOLOR");
    EXPECT_EQ(fieldOf(map + "&SLD_BODY=x"), "SLD_BODY");
    EXPECT_EQ(fieldOf(map + "&time=2019"), "TIME");
    EXPECT_EQ(fieldOf(map + "&time=&elevation=default"), "");
    EXPECT_EQ(fieldOf(map + "&eye=1,2,3"), "eye");
    EXPECT_EQ(fieldOf(map + "&viewHeight=1"), "viewHeight");
    EXPECT_EQ(fieldOf(map + "&methd=ewa"), "methd");
    EXPECT_EQ(fieldOf("request=GetMap&version=1.0.0"), "VERSION");
    const std::string rest = "&width=3&height=3";
    for (const char* box :
         {"", "1,2,3", "1,2,3,4,5", "1,2,1,4", "1,2,nan,4", "1,2,inf,4", "1,2,3,1e99", "a,b,c,d", "1 ,2,3,4"})
        EXPECT_EQ(fieldOf("request=GetMap&crs=file&bbox=" + std::string(box) + rest), "BBOX") << box;
    EXPECT_EQ(fieldOf("request=GetMap&crs=file&bbox=1,2,3,4&width=0&height=3"), "WIDTH");
    EXPECT_EQ(fieldOf("request=GetMap&crs=file&bbox=1,2,3,4&width=3&height=16385"), "HEIGHT");
    EXPECT_EQ(fieldOf("request=GetMap&bbox=1,2,3,4" + rest), "CRS");
    EXPECT_EQ(fieldOf("request=GetFeatureInfo&crs=file&bbox=1,2,3,4&i=3&j=0" + rest), "I");
    EXPECT_EQ(fieldOf("request=GetFeatureInfo&crs=file&bbox=1,2,3,4&i=1&j=-1" + rest), "J");
    const std::string info = "request=GetFeatureInfo&crs=file&bbox=1,2,3,4&i=1&j=1" + rest;
    for (const char* count : {"", "1", "10"})
        EXPECT_EQ(fieldOf(info + "&feature_count=" + count), "") << count;
    for (const char* count : {"0", "-1", "all"})
        EXPECT_EQ(fieldOf(info + "&feature_count=" + count), "FEATURE_COUNT") << count;
}

TEST(MapRequest, TilesByEitherAddress) {
    const auto path = parseTileRequest("mercator", "3", "7", "2.jpg", "style=elevation&method=ewa");
    const auto words = parseWmtsRequest(
        "SERVICE=WMTS&REQUEST=GetTile&LAYER=town&STYLE=elevation&FORMAT=image/"
        "jpeg&TILEMATRIXSET=mercator&TILEMATRIX=3&TILEROW=2&TILECOL=7&method=ewa",
        "town");
    ASSERT_TRUE(path && words);
    const auto& tile = std::get<TileRequest>(*words);
    EXPECT_EQ(path->words, tile.words);
    EXPECT_EQ(path->x, tile.x);
    EXPECT_EQ(path->y, 2U);
    EXPECT_EQ(path->format, PictureFormat::Jpeg);
    for (const auto& [set, z, x, y, field] :
         std::vector<std::array<const char*, 5>>{{"world", "0", "0", "0.png", "TILEMATRIXSET"},
                                                 {"file", "25", "0", "0.png", "TILEMATRIX"},
                                                 {"file", "-1", "0", "0.png", "TILEMATRIX"},
                                                 {"file", "2", "4", "0.png", "TILECOL"},
                                                 {"file", "2", "3", "4.png", "TILEROW"},
                                                 {"file", "2", "3", "3", "FORMAT"},
                                                 {"file", "2", "3", "3.tif", "FORMAT"}}) {
        const auto wrong = parseTileRequest(set, z, x, y, "");
        ASSERT_FALSE(wrong);
        EXPECT_EQ(wrong.error().field, field);
    }
}

TEST(TileSets, CoverTheCloudAndHalve) {
    for (const double side : {0.37, 96.0, 128.0, 1e5}) {
        for (const glm::dvec2 low :
             {glm::dvec2(389452.13, 5819752.07), glm::dvec2(-0.4, -77.7), glm::dvec2(0)}) {
            CloudFacts cloud;
            cloud.bounds = {glm::dvec3(low, 0), glm::dvec3(low + glm::dvec2(side, side / 3), 5)};
            cloud.spacing = side / 500;
            const TileSet set = fileTiles(cloud);
            const MapExtent whole = set.extentOf(0, 0, 0);
            EXPECT_TRUE(whole.low.x <= low.x && whole.low.y <= low.y && whole.high.x >= low.x + side &&
                        whole.high.y >= low.y + side / 3);
            EXPECT_LT(whole.high.x - whole.low.x, 4.1 * side) << "and not much more";
            EXPECT_EQ(std::fmod(whole.low.x, set.pixel), 0);
            EXPECT_EQ(std::exp2(std::round(std::log2(set.pixel))), set.pixel);
            const MapExtent right = set.extentOf(2, 3, 3);
            EXPECT_EQ(right.high.x, whole.high.x);
            EXPECT_EQ(right.low.y, whole.low.y);
            EXPECT_LE(set.side(set.levels - 1) / tileSide, cloud.spacing / 8 * 1.001);
            const TileRange range = tilesIn(set, 0, cloud.bounds[0], cloud.bounds[1]);
            EXPECT_EQ(range.right + range.bottom, 0U);
        }
    }
}

TEST(ServiceException, SaysWhatServicesSay) {
    const Problem problem = problemOf(400, "CRS <must> & \"so\"\x01");
    const HttpResponse wms = exceptionResponse(MapService::Wms, problem, "CRS");
    EXPECT_EQ(wms.status, 400);
    EXPECT_THAT(wms.text, testing::HasSubstr("<ServiceException code=\"InvalidCRS\" locator=\"CRS\">CRS "
                                             "&lt;must&gt; &amp; &quot;so&quot;?</ServiceException>"));
    EXPECT_THAT(exceptionResponse(MapService::Wmts, problem, "TILEROW").text,
                testing::HasSubstr("exceptionCode=\"TileOutOfRange\" locator=\"TILEROW\""));
    EXPECT_EQ(*exceptionResponse(MapService::Plain, problem).find("Content-Type"),
              "application/problem+json");
    EXPECT_EQ(xmlText("a\xff<"), "a?&lt;");
}

TEST(PublicUrl, IsTheHostsUnlessAProxyIsTrusted) {
    HttpRequest request{"GET",
                        "/",
                        {{"host", "scans.example.org:8080"},
                         {"x-forwarded-proto", "HTTPS"},
                         {"x-forwarded-prefix", "/town/"}}};
    EXPECT_EQ(publicUrl(request, false, false), "http://scans.example.org:8080");
    EXPECT_EQ(publicUrl(request, true, false), "https://scans.example.org:8080");
    EXPECT_EQ(publicUrl(request, false, true), "https://scans.example.org:8080/town");
    request.headers[1].second = "javascript";
    for (const char* prefix : {"town", "/a\"b", "/a b", "//evil?x", "/%2e"}) {
        request.headers[2].second = prefix;
        EXPECT_EQ(publicUrl(request, false, true), "http://scans.example.org:8080");
    }
}

}  // namespace
}  // namespace scancast
