#include "renderer/raster/geo_keys.hpp"

#include <gtest/gtest.h>

namespace scancast::test {
namespace {

std::vector<GeoKey> keysOf(std::string wkt, std::optional<int> epsg) {
    CloudFacts facts;
    facts.crsWkt = std::move(wkt);
    facts.crsEpsg = epsg;
    return geoKeys(facts);
}

bool has(const std::vector<GeoKey>& keys, std::uint16_t key, std::uint16_t value) {
    return std::ranges::find(keys, GeoKey{key, value}) != keys.end();
}

TEST(GeoKeys, NumbersStandWhereTheyAreKnown) {
    const auto utm = keysOf("", 25833);
    EXPECT_TRUE(has(utm, 1024, 1) && has(utm, 1025, 1) && has(utm, 3072, 25833));
    const auto degrees = keysOf("", 4326);
    EXPECT_TRUE(has(degrees, 1024, 2) && has(degrees, 2048, 4326));
    EXPECT_TRUE(std::ranges::is_sorted(utm, {}, &GeoKey::key));
    EXPECT_EQ(keysOf("", std::nullopt), (std::vector<GeoKey>{{1025, std::uint16_t(1)}}))
        << "nothing is made up";
}

TEST(GeoKeys, ACrsWithoutANumberIsItsText) {
    const std::string wkt =
        "PROJCS[\"Site\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"s\",6378137,298.257223563]],PRIMEM["
        "\"Greenwich\",0],"
        "UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"central_"
        "meridian\",9],"
        "UNIT[\"US survey foot\",0.304800609601219]]";
    const auto keys = keysOf(wkt, std::nullopt);
    EXPECT_TRUE(has(keys, 3072, 32767) && has(keys, 3076, 9003) && has(keys, 4099, 9003));
    const auto at = std::ranges::find(keys, 3073, &GeoKey::key);
    ASSERT_NE(at, keys.end());
    EXPECT_EQ(std::get<std::string>(at->value), "ESRI PE String = " + wkt);
}

}  // namespace
}  // namespace scancast::test
