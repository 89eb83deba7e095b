#include "renderer/raster/geo_keys.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

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

double realOf(const std::vector<GeoKey>& keys, std::uint16_t key) {
    const auto at = std::ranges::find(keys, key, &GeoKey::key);
    const double* const real = at == keys.end() ? nullptr : std::get_if<double>(&at->value);
    return real != nullptr ? *real : std::numeric_limits<double>::quiet_NaN();
}

TEST(GeoKeys, ANumberIsFoundByWhatATextSays) {
    // As programs of Esri write it: EPSG:2994, Oregon, in feet.
    const auto keys = keysOf(
        "PROJCS[\"NAD_1983_HARN_Oregon_Statewide_Lambert_Feet_Intl\",GEOGCS[\"GCS_North_American_1983_HARN\","
        "DATUM[\"D_North_American_1983_HARN\",SPHEROID[\"GRS_1980\",6378137.0,298.257222101]],PRIMEM["
        "\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Lambert_Conformal_Conic\"],"
        "PARAMETER[\"False_Easting\",1312335.958005249],PARAMETER[\"False_Northing\",0.0],PARAMETER["
        "\"Central_Meridian\",-120.5],PARAMETER[\"Standard_Parallel_1\",43.0],PARAMETER[\"Standard_Parallel_"
        "2\","
        "45.5],PARAMETER[\"Latitude_Of_Origin\",41.75],UNIT[\"Foot\",0.3048]]",
        std::nullopt);
    EXPECT_TRUE(has(keys, 1024, 1) && has(keys, 3072, 2994) && has(keys, 4099, 9002));
}

TEST(GeoKeys, ACrsWithoutANumberIsWhatItIsMadeOf) {
    const std::string wkt =
        "PROJCS[\"Site\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"s\",6378138,298.25]],PRIMEM[\"Greenwich\",0],"
        "UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER["
        "\"latitude_of_origin\",45],PARAMETER[\"central_meridian\",9.25],PARAMETER[\"scale_factor\",0.99995],"
        "PARAMETER[\"false_easting\",3000],PARAMETER[\"false_northing\",600],UNIT[\"US survey "
        "foot\",0.304800609601219]]";
    const auto keys = keysOf(wkt, std::nullopt);
    EXPECT_TRUE(has(keys, 1024, 1) && has(keys, 3072, 32767) && has(keys, 3075, 1) && has(keys, 3076, 9003) &&
                has(keys, 4099, 9003));
    EXPECT_TRUE(has(keys, 2048, 32767)) << "nor has that ellipsoid a number";
    EXPECT_NEAR(realOf(keys, 2057), 6378138, 1e-6);
    EXPECT_NEAR(realOf(keys, 2059), 298.25, 1e-9);
    EXPECT_NEAR(realOf(keys, 3080), 9.25, 1e-12);
    EXPECT_NEAR(realOf(keys, 3081), 45, 1e-12);
    EXPECT_NEAR(realOf(keys, 3092), 0.99995, 1e-12);
    EXPECT_NEAR(realOf(keys, 3082), 3000, 1e-6) << "in its own feet";
    EXPECT_NEAR(realOf(keys, 3083), 600, 1e-6);
}

TEST(GeoKeys, AProjectionWithoutWordsIsNamedAndNoMore) {
    const std::string wkt =
        "PROJCS[\"Globe\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
        "84\",6378137,298.257223563]],PRIMEM["
        "\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Mollweide\"],PARAMETER["
        "\"central_meridian\",9.25],UNIT[\"metre\",1]]";
    const auto keys = keysOf(wkt, std::nullopt);
    EXPECT_EQ(std::ranges::find(keys, 1024, &GeoKey::key), keys.end());
    EXPECT_NE(std::ranges::find(keys, 1026, &GeoKey::key), keys.end());
}

}  // namespace
}  // namespace scancast::test
