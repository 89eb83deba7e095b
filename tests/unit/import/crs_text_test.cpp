// Names, units and numbers of coordinate reference systems, from WKT as programs write it.
#include "renderer/cloud/import/crs_text.hpp"

#include <gtest/gtest.h>

#include "protocol/classification.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/test_data.hpp"

namespace scancast::test {

namespace {

const std::string utm =
    R"(PROJCS["NAD83 / UTM zone 10N",GEOGCS["NAD83",DATUM["North_American_Datum_1983",)"
    R"(SPHEROID["GRS 1980",6378137,298.257222101,AUTHORITY["EPSG","7019"]],AUTHORITY["EPSG","6269"]],)"
    R"(UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4269"]],PROJECTION["Transverse_Mercator"],)"
    R"(UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],AUTHORITY["EPSG","26910"]])";

/// The same without the number of the whole.
std::string withoutOwnNumber() {
    auto wkt = utm.substr(0, utm.rfind(",AUTHORITY"));
    wkt += ']';
    return wkt;
}

const std::string vertical =
    R"(VERT_CS["NAVD88 height",UNIT["US survey foot",0.3048006096012192],AUTHORITY["EPSG","6360"]])";

std::string compound(const std::string& horizontal, const char* number = "") {
    std::string wkt = R"(COMPD_CS["both",)";
    for (const char* part : {horizontal.c_str(), ",", vertical.c_str(), number, "]"}) wkt += part;
    return wkt;
}

}  // namespace

TEST(CrsText, TheNumberIsThatOfTheWhole) {
    EXPECT_EQ(epsgOfWkt(utm), 26910);
    // Datum, ellipsoid and unit have numbers, too: none of them is the CRS's.
    EXPECT_EQ(epsgOfWkt(withoutOwnNumber()), std::nullopt);
    EXPECT_EQ(epsgOfWkt(compound(utm)), 26910);
    EXPECT_EQ(epsgOfWkt(compound(utm, R"(,AUTHORITY["EPSG","6339"])")), 6339);
    EXPECT_EQ(epsgOfWkt(compound(withoutOwnNumber())), std::nullopt);
    EXPECT_EQ(
        epsgOfWkt(
            R"(PROJCRS["ETRS89 / UTM zone 33N",BASEGEOGCRS["ETRS89",ID["EPSG",4258]],ID["EPSG",25833]])"),
        25833);
    EXPECT_EQ(epsgOfWkt(R"(PROJCS["a",AUTHORITY["ESRI","102100"]])"), std::nullopt);
    EXPECT_EQ(epsgOfWkt(R"(PROJCS["a",AUTHORITY["EPSG","99999999999"]])"), std::nullopt);
    EXPECT_EQ(epsgOfWkt(R"(PROJCS["a",AUTHORITY["EPSG","12x"]])"), std::nullopt);
}

TEST(CrsText, Names) {
    EXPECT_EQ(crsName(utm, 26910), "NAD83 / UTM zone 10N (EPSG:26910)");
    EXPECT_EQ(crsName(utm, std::nullopt), "NAD83 / UTM zone 10N");
    EXPECT_EQ(crsName(R"(GEOGCS["say ""hello"" ]"])", std::nullopt), "say \"hello\" ]");
    EXPECT_EQ(crsName("", 32733), "WGS 84 / UTM zone 33S (EPSG:32733)");
    EXPECT_EQ(crsName("", 32601), "WGS 84 / UTM zone 1N (EPSG:32601)");
    EXPECT_EQ(crsName("", 25833), "ETRS89 / UTM zone 33N (EPSG:25833)");
    EXPECT_EQ(crsName("", 4326), "WGS 84 (EPSG:4326)");
    EXPECT_EQ(crsName("", 2229), "EPSG:2229");
    EXPECT_EQ(crsName("", std::nullopt), "");
}

TEST(CrsText, UnitsOfXAndY) {
    EXPECT_EQ(crsUnit(utm, std::nullopt), "metre");
    EXPECT_EQ(crsUnit(compound(utm), std::nullopt), "metre");
    EXPECT_EQ(crsUnit(R"(GEOGCS["WGS 84",UNIT["Degree",0.017453292519943295]])", 4326), "degree");
    EXPECT_EQ(crsUnit(R"(PROJCS["a",UNIT["Foot_US",0.30480060960121924]])", std::nullopt), "US survey foot");
    EXPECT_EQ(crsUnit(R"(PROJCS["a",UNIT["foot",0.3048]])", std::nullopt), "foot");
    EXPECT_EQ(crsUnit(R"(PROJCS["a",UNIT["Chain_Clarke",20.1166]])", std::nullopt), "Chain Clarke");
    EXPECT_EQ(
        crsUnit(R"wkt(PROJCRS["a",CS[Cartesian,2],AXIS["(E)",east,LENGTHUNIT["metre",1]]])wkt", std::nullopt),
        "metre");
    EXPECT_EQ(crsUnit("", 32610), "metre");
    EXPECT_EQ(crsUnit("", 2229), "");
}

TEST(CrsText, AnythingElseGivesNothing) {
    std::string deep;
    for (int i = 0; i < 100000; ++i) deep += "A[";
    std::string wide = "A[1";
    for (int i = 0; i < 100000; ++i) wide += ",1";
    wide += ']';
    for (const std::string& text :
         {std::string(), std::string("''"), std::string("PROJCS"), std::string("PROJCS["),
          std::string("PROJCS[]"), std::string("PROJCS[\"a\")"), std::string("[\"a\"]"),
          std::string("PROJCS[\"a\"]x"), std::string("PROJCS[\"a]"), deep, wide}) {
        EXPECT_EQ(epsgOfWkt(text), std::nullopt);
        EXPECT_EQ(crsName(text, std::nullopt), "");
        EXPECT_EQ(crsUnit(text, std::nullopt), "");
    }
}

TEST(CrsText, OfRealFiles) {
    struct Real {
        const char* file;
        const char* name;
        const char* unit;
    };
    for (const auto& [file, expected, unit] :
         {Real{"las/autzen_trim.las", "NAD_1983_HARN_Lambert_Conformal_Conic", "foot"},
          Real{"las/las14-evlr.las", "NAD83(HARN) / New Mexico Central (ftUS) (EPSG:2903)", "US survey foot"},
          Real{"las/las14-pdrf6-wkt.las", "NAD83_2011_Nebraska_ft (EPSG:32104)", "US survey foot"},
          Real{"las/las14-pdrf7-color.las", "Geographic Coordinate System (EPSG:4326)", "degree"},
          Real{"las/permutation-1.2_3.las", "NAD83 / UTM zone 15N (EPSG:26915)", "metre"},
          Real{"las/warsaw_small.las", "", ""}}) {
        REQUIRE_TEST_DATA(file);
        const auto source = openScan(testData(file));
        ASSERT_TRUE(source) << source.error().message;
        const auto& header = (*source)->header();
        EXPECT_EQ(crsName(header.crsWkt, header.crsEpsg), expected) << file;
        EXPECT_EQ(crsUnit(header.crsWkt, header.crsEpsg), unit) << file;
    }
}

TEST(Classification, EveryClassHasAName) {
    EXPECT_EQ(className(0), "never classified");
    EXPECT_EQ(className(2), "ground");
    EXPECT_EQ(className(6), "building");
    EXPECT_EQ(className(9), "water");
    EXPECT_EQ(className(18), "high noise");
    EXPECT_EQ(className(19), "reserved");
    EXPECT_EQ(className(63), "reserved");
    EXPECT_EQ(className(64), "user defined");
    EXPECT_EQ(className(255), "user defined");
}

}  // namespace scancast::test
