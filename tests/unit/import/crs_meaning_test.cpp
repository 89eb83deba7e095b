// What coordinate reference systems mean, whatever program spelled them: WKT 1 of GDAL, of Esri and of GeoTIFF, WKT 2,
// compounds, bare numbers. Oracle: the parameters of the systems themselves, as EPSG's register has them.
#include "renderer/cloud/import/crs_meaning.hpp"

#include <gmock/gmock.h>

#include "renderer/cloud/import/assumed_crs.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/test_data.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = CrsMeaning::Kind;

namespace {

std::string gdalUtm(int zone, const char* number = "") {
    return R"(PROJCS["ETRS89 / UTM zone )" + std::to_string(zone) +
           R"(N",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",SPHEROID["GRS 1980",6378137,298.257222101]],)"
           R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4258"]],)"
           R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",)" +
           std::to_string(6 * zone - 183) +
           R"(],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],)"
           R"(UNIT["metre",1])" +
           number + "]";
}

std::string numbered(int epsg) {
    return R"(,AUTHORITY["EPSG",")" + std::to_string(epsg) + R"("])";
}

const std::string esriUtm32 =
    R"(PROJCS["ETRS_1989_UTM_Zone_32N",GEOGCS["GCS_ETRS_1989",DATUM["D_ETRS_1989",SPHEROID["GRS_1980",6378137.0,298.257222101]],)"
    R"(PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
    R"(PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",9.0],)"
    R"(PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]])";

std::string wkt2Utm(int zone) {
    return R"(PROJCRS["ETRS89 / UTM zone )" + std::to_string(zone) +
           R"(N",BASEGEOGCRS["ETRS89",ENSEMBLE["European Terrestrial Reference System 1989 ensemble",)"
           R"(ELLIPSOID["GRS 1980",6378137,298.257222101,LENGTHUNIT["metre",1]]],PRIMEM["Greenwich",0,)"
           R"(ANGLEUNIT["degree",0.0174532925199433]],ID["EPSG",4258]],CONVERSION["UTM",METHOD["Transverse Mercator"],)"
           R"(PARAMETER["Latitude of natural origin",0,ANGLEUNIT["degree",0.0174532925199433]],)"
           R"(PARAMETER["Longitude of natural origin",)" +
           std::to_string(6 * zone - 183) +
           R"(,ANGLEUNIT["degree",0.0174532925199433]],PARAMETER["Scale factor at natural origin",0.9996,SCALEUNIT["unity",1]],)"
           R"(PARAMETER["False easting",500000,LENGTHUNIT["metre",1]],PARAMETER["False northing",0,LENGTHUNIT["metre",1]]],)"
           R"wkt(CS[Cartesian,2],AXIS["(E)",east,ORDER[1],LENGTHUNIT["metre",1]],AXIS["(N)",north,ORDER[2],LENGTHUNIT["metre",1]]])wkt";
}

std::string withHeights(const std::string& horizontal, const char* number = "") {
    return R"(COMPD_CS["ETRS89 / UTM zone 32N + DHHN92 height",)" + horizontal +
           R"(,VERT_CS["DHHN92 height",VERT_DATUM["x",2005],UNIT["metre",1],AUTHORITY["EPSG","5783"]])" +
           number + "]";
}

/// Lambert in metres, or in feet of which false origins are numbers.
std::string lambert(const char* name, double foot, double falseEasting, bool esri,
                    double longitude = -120.5) {
    const std::string datum = esri ? "D_North_American_1983_HARN" : "North_American_1983_HARN";
    return std::string("PROJCS[\"") + name + R"(",GEOGCS["g",DATUM[")" + datum +
           R"(",SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)"
           R"(PROJECTION["Lambert_Conformal_Conic_2SP"],PARAMETER["standard_parallel_1",)" +
           (esri ? "43" : "45.5") + R"(],PARAMETER["standard_parallel_2",)" + (esri ? "45.5" : "43") +
           R"(],PARAMETER["latitude_of_origin",41.75],PARAMETER["central_meridian",)" +
           std::to_string(longitude) + R"(],PARAMETER["false_easting",)" + std::to_string(falseEasting) +
           R"(],PARAMETER["false_northing",0],UNIT["u",)" + std::to_string(foot) + "]]";
}

CrsRelation related(const std::string& a, const std::string& b) {
    const auto one = crsMeaning(a, std::nullopt), other = crsMeaning(b, std::nullopt);
    EXPECT_TRUE(one && other);
    const auto relation = compare(*one, *other);
    EXPECT_EQ(compare(*other, *one), relation) << "it goes both ways";
    return relation;
}

CrsRelation related(const std::string& a, int b) {
    return compare(*crsMeaning(a, std::nullopt), *crsMeaning("", b));
}

}  // namespace

TEST(CrsMeaning, OneSystemInEverySpelling) {
    const std::string spellings[] = {
        gdalUtm(32),
        gdalUtm(32, numbered(25832).c_str()),
        esriUtm32,
        wkt2Utm(32),
        withHeights(gdalUtm(32)),
        withHeights(gdalUtm(32, numbered(25832).c_str()), numbered(5555).c_str()),
        withHeights(gdalUtm(32), numbered(5555).c_str()),
        "BOUNDCRS[SOURCECRS[" + wkt2Utm(32) + "],TARGETCRS[GEOGCRS[\"WGS 84\"]]]"};
    for (const auto& spelling : spellings) {
        const auto meaning = crsMeaning(spelling, std::nullopt);
        ASSERT_TRUE(meaning) << spelling;
        EXPECT_EQ(meaning->kind, Kind::Projected) << spelling;
        EXPECT_EQ(meaning->unit, 1) << spelling;
        EXPECT_EQ(meaning->name, "etrs 89 utm 32 n") << spelling;
        EXPECT_NEAR(meaning->parameter[CrsMeaning::Longitude].value_or(0), 9, 1e-9) << spelling;
        EXPECT_EQ(meaning->parameter[CrsMeaning::FalseEasting], 500000) << spelling;
        EXPECT_EQ(related(spelling, 25832), CrsRelation::Same) << spelling;
        EXPECT_EQ(related(spelling, 25833), CrsRelation::Different) << spelling;
        for (const auto& other : spellings)
            EXPECT_EQ(related(spelling, other), CrsRelation::Same) << spelling << other;
        EXPECT_EQ(related(spelling, gdalUtm(33)), CrsRelation::Different) << spelling;
        EXPECT_EQ(related(spelling, wkt2Utm(31)), CrsRelation::Different) << spelling;
    }
}

TEST(CrsMeaning, NumbersOfCompoundsMeanWhatXAndYAre) {
    const auto of = [](int epsg) { return *crsMeaning("", epsg); };
    EXPECT_EQ(of(5555).epsg, 25832);
    EXPECT_EQ(compare(of(5555), of(25832)), CrsRelation::Same);
    EXPECT_EQ(compare(of(7415), of(28992)), CrsRelation::Same);
    EXPECT_EQ(compare(of(5555), of(25833)), CrsRelation::Different);
    // A compound whose number is not known here, over parts without numbers, is no other number.
    const auto strange = crsMeaning(withHeights(gdalUtm(32), numbered(6999).c_str()), 6999);
    EXPECT_EQ(strange->epsg, std::nullopt);
    EXPECT_EQ(compare(*strange, of(25832)), CrsRelation::Same) << "by its name";
}

TEST(CrsMeaning, WhatIsProvedToDiffer) {
    const std::string feet = lambert("Oregon North", 0.3048, 1312335.958, false);
    EXPECT_EQ(related(feet, lambert("Oregon_North", 0.3048006096012192, 1312335.958, false)),
              CrsRelation::Different)
        << "the two feet are metres apart at such eastings";
    EXPECT_EQ(related(feet, lambert("Oregon North", 1, 400000, false)), CrsRelation::Different);
    EXPECT_EQ(related(feet, lambert("a", 0.3048, 1312335.958, false, -120)), CrsRelation::Different);
    EXPECT_EQ(related(feet, lambert("a", 0.3048, 1312330, false)), CrsRelation::Different);
    EXPECT_EQ(related(gdalUtm(32), R"(GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]])"),
              CrsRelation::Different);
    EXPECT_EQ(related(gdalUtm(32), 4326), CrsRelation::Different);
    EXPECT_EQ(related(R"(PROJCS["WGS 84 / UTM zone 33N",UNIT["metre",1]])",
                      R"(PROJCS["WGS 84 / UTM zone 33S",UNIT["metre",1]])"),
              CrsRelation::Different);
    EXPECT_EQ(related(R"(GEOCCS["WGS 84",UNIT["metre",1]])", gdalUtm(32)), CrsRelation::Different);
    EXPECT_EQ(related(R"(GEODCRS["WGS 84",CS[Cartesian,3],AXIS["X",geocentricX],LENGTHUNIT["metre",1]])",
                      gdalUtm(32)),
              CrsRelation::Different);
}

TEST(CrsMeaning, ParametersProveWhatNamesDoNot) {
    // Esri and GDAL: other names, parallels the other way round, the datum in two spellings.
    EXPECT_EQ(related(lambert("NAD83(HARN) / Oregon North (ft)", 0.3048, 1312335.958, false),
                      lambert("NAD_1983_HARN_StatePlane_Oregon_North_FIPS_3601_Feet_Intl", 0.3048,
                              1312335.958, true)),
              CrsRelation::Same);
}

TEST(CrsMeaning, NothingIsMadeUp) {
    EXPECT_EQ(related(R"(PROJCS["Site grid",UNIT["metre",1]])", R"(PROJCS["Plant grid",UNIT["metre",1]])"),
              CrsRelation::Unclear);
    EXPECT_EQ(related(R"(PROJCS["unnamed",UNIT["metre",1]])",
                      R"(PROJCS["unnamed",UNIT["metre",1],AXIS["x",EAST]])"),
              CrsRelation::Unclear)
        << "that both have no name does not make them one";
    EXPECT_EQ(related(R"(LOCAL_CS["a"])", R"(LOCAL_CS["b"])"), CrsRelation::Unclear);
    EXPECT_EQ(related("not a WKT", "not  a WKT"), CrsRelation::Same) << "word for word";
    EXPECT_EQ(related("not a WKT", 25832), CrsRelation::Unclear);
    EXPECT_EQ(related(R"(PROJCS["Site grid",UNIT["metre",1]])", 2154), CrsRelation::Unclear);
    EXPECT_EQ(compare(*crsMeaning("", 2154), *crsMeaning("", 2154)), CrsRelation::Same);
    EXPECT_EQ(crsMeaning("", std::nullopt), std::nullopt);
    // Longitudes from Paris and from Greenwich are not held against each other.
    const std::string paris =
        R"(PROJCS["NTF",GEOGCS["NTF",DATUM["NTF"],PRIMEM["Paris",2.33722917],UNIT["grad",0.01570796326794897]],)"
        R"(PARAMETER["central_meridian",0],PARAMETER["latitude_of_origin",52],UNIT["metre",1]])";
    EXPECT_EQ(crsMeaning(paris, std::nullopt)->parameter[CrsMeaning::Longitude], std::nullopt);
    EXPECT_NEAR(*crsMeaning(paris, std::nullopt)->parameter[CrsMeaning::Latitude], 46.8, 1e-9) << "grads";
}

TEST(CrsMeaning, OfRealFiles) {
    struct Pair {
        const char *a, *b;
        CrsRelation relation;
    };
    for (const auto& [a, b, relation] :
         {Pair{"las/permutation-1.2_3.las", "las/permutation-1.0_0.las", CrsRelation::Same},
          Pair{"las/autzen_trim.las", "las/permutation-1.0_0.las", CrsRelation::Different},
          Pair{"las/autzen_trim.las", "las/lonlat-pdrf0.las", CrsRelation::Different},
          // The numbers say metres, the words feet: it is not the system of that number.
          Pair{"las/las14-pdrf6-wkt.las", "las/certainty3d-feet.las", CrsRelation::Different}}) {
        REQUIRE_TEST_DATA(a);
        REQUIRE_TEST_DATA(b);
        const auto one = openScan(testData(a)), other = openScan(testData(b));
        ASSERT_TRUE(one && other);
        const auto of = [](const ScanHeader& h) { return crsMeaning(h.crsWkt, h.crsEpsg); };
        EXPECT_EQ(compare(*of((*one)->header()), *of((*other)->header())), relation) << a << " " << b;
    }
}

TEST(AssumedCrs, NumbersAndTexts) {
    EXPECT_EQ(parseCrs("EPSG:25832"), (AssumedCrs{"", 25832}));
    EXPECT_EQ(parseCrs("epsg:4326"), (AssumedCrs{"", 4326}));
    EXPECT_EQ(parseCrs(gdalUtm(32, numbered(25832).c_str()))->epsg, 25832);
    EXPECT_EQ(parseCrs(esriUtm32), (AssumedCrs{esriUtm32, std::nullopt}));
    for (const char* wrong :
         {"", "EPSG:", "EPSG:0", "EPSG:99999", "EPSG:12a", "EPSG", "25832", "UNIT[\"metre\",1]",
          "VERT_CS[\"height\"]", "CS[Cartesian,2]", "PROJCS[\"a\""}) {
        const auto crs = parseCrs(wrong);
        ASSERT_FALSE(crs) << wrong;
        EXPECT_EQ(crs.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(crs.error().message, HasSubstr("EPSG:25832"));
    }
}

TEST(AssumedCrs, StandsInPlaceOfTheScans) {
    class Told final : public PointSource {
      public:
        explicit Told(std::optional<int> epsg) { header_.crsEpsg = epsg, header_.points = 7; }
        const ScanHeader& header() const override { return header_; }
        Expected<bool> read(PointBatch&) override { return false; }
        std::uint64_t droppedPoints() const override { return 3; }
        std::vector<std::string> notes() const override { return {"own"}; }

      private:
        ScanHeader header_;
    };
    const auto notesOf = [](std::optional<int> own, int taken) {
        const auto source = withCrs(std::make_unique<Told>(own), {"", taken}, "/scans/a.las");
        EXPECT_EQ(source->header().crsEpsg, taken);
        EXPECT_EQ(source->header().points, 7U);
        EXPECT_EQ(source->droppedPoints(), 3U);
        return source->notes();
    };
    EXPECT_THAT(notesOf(std::nullopt, 25832), ElementsAre("own"));
    EXPECT_THAT(notesOf(25832, 25832), ElementsAre("own"));
    EXPECT_THAT(
        notesOf(25833, 25832),
        ElementsAre("a.las: it says that it is in ETRS89 / UTM zone 33N (EPSG:25833); ETRS89 / UTM zone 32N "
                    "(EPSG:25832) is taken instead, as was asked for",
                    "own"));
}

}  // namespace scancast::test
