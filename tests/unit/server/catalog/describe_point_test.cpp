// What is said of a point: numbers that a double has not are strings, and none is rounded on the way.
#include "server/catalog/describe_point.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

namespace scancast::test {
namespace {

template <class T>
void add(KeptPoint& point, const char* name, ColumnType type, T value, double scale = 1, double offset = 0) {
    point.columns.push_back({name, type, scale, offset, ""});
    const std::size_t at = point.row.size();
    point.row.resize(at + sizeof value);
    std::memcpy(point.row.data() + at, &value, sizeof value);
}

TEST(DescribePoint, NumbersKeepAllTheirBits) {
    KeptPoint point;
    add(point, "flags", ColumnType::Uint8, std::uint8_t(3));
    add(point, "small", ColumnType::Int64, std::int64_t(-9007199254740991));
    add(point, "below", ColumnType::Int64, std::numeric_limits<std::int64_t>::min());
    add(point, "above", ColumnType::Uint64, std::numeric_limits<std::uint64_t>::max());
    add(point, "time", ColumnType::Float64, 245379.39816229);
    add(point, "real", ColumnType::Float32, 0.1F);
    add(point, "scaled", ColumnType::Int16, std::int16_t(-250), 0.006, 1.5);
    add(point, "none", ColumnType::Float64, std::numeric_limits<double>::quiet_NaN());
    const auto values = attributesJson(point);
    EXPECT_EQ(values["flags"], 3);
    EXPECT_EQ(values["small"], -9007199254740991);
    EXPECT_EQ(values["below"], "-9223372036854775808");
    EXPECT_EQ(values["above"], "18446744073709551615");
    EXPECT_EQ(values["time"].get<double>(), 245379.39816229);
    EXPECT_EQ(values["real"].get<double>(), double(0.1F));
    EXPECT_EQ(values["scaled"].get<double>(), 1.5 + 0.006 * -250);
    EXPECT_TRUE(values["none"].is_null());
}

TEST(DescribePoint, CoordinatesSayWhatTheyAreIn) {
    CloudFacts facts;
    EXPECT_TRUE(crsJson(facts).is_null()) << "nothing is known";
    facts.crsWkt =
        R"(COMPD_CS["NAD83 / Oregon + NAVD88",PROJCS["NAD83 / Oregon",GEOGCS["NAD83",DATUM["D",SPHEROID["S",6378137,298.25]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic_2SP"],UNIT["foot",0.3048],AUTHORITY["EPSG","2994"]],VERT_CS["NAVD88 height",VERT_DATUM["NAVD88",2005],UNIT["metre",1],AUTHORITY["EPSG","5703"]]])";
    facts.crsEpsg = 2994;
    EXPECT_EQ(crsJson(facts), nlohmann::json({{"name", "NAD83 / Oregon + NAVD88 (EPSG:2994)"},
                                              {"epsg", 2994},
                                              {"unit", "foot"},
                                              {"verticalName", "NAVD88 height"},
                                              {"verticalEpsg", 5703},
                                              {"verticalUnit", "metre"}}));
}

}  // namespace
}  // namespace scancast::test
