#include <gtest/gtest.h>

#include "simulator/write/point_count.hpp"

namespace scancast {
namespace {

TEST(PointCount, ReadsWhatPeopleWrite) {
    EXPECT_EQ(parsePointCount("1"), 1u);
    EXPECT_EQ(parsePointCount("20M"), 20'000'000u);
    EXPECT_EQ(parsePointCount("1.5e6"), 1'500'000u);
    EXPECT_EQ(parsePointCount("2_000_000"), 2'000'000u);
    EXPECT_EQ(parsePointCount("500k"), 500'000u);
    EXPECT_EQ(parsePointCount("1.25G"), 1'250'000'000u);
    EXPECT_EQ(parsePointCount("1e12"), 1'000'000'000'000u);
}

TEST(PointCount, RefusesTheRest) {
    for (const char* text :
         {"", "0", "-5", "M", "1.5", "0.0001k", "1e13", "nan", "inf", "12q", "1 000", "0x10", "_1", "1_",
          "1e999", "99999999999999999999999999999999999999999999999999999999999999999999999999"}) {
        const auto count = parsePointCount(text);
        ASSERT_FALSE(count) << text;
        EXPECT_EQ(count.error().code, ErrorCode::InvalidArgument) << text;
        EXPECT_NE(count.error().message.find("20M"), std::string::npos) << "no way out is named";
    }
}

}  // namespace
}  // namespace scancast
