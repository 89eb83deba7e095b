// The words `color=column:NAME` and `filter`: what they take, what they refuse, and that nothing is lost on the way through JSON.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "protocol/points/points_region.hpp"
#include "protocol/view/view_json.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

ColumnRanges ranges(std::string_view text) {
    View view;
    const auto applied = applyWord(view, "filter", text);
    EXPECT_TRUE(applied) << applied.error().message;
    return view.style.filter;
}

TEST(ColumnRangesWord, IsAListOfNamesAndEnds) {
    EXPECT_EQ(ranges("gps_time:1.5..1e3"), (ColumnRanges{{"gps_time", 1.5, 1000.0}}));
    EXPECT_EQ(ranges("a:..5;b:-3.."), (ColumnRanges{{"a", {}, 5.0}, {"b", -3.0, {}}}));
    EXPECT_EQ(ranges("a:-2..-1"), (ColumnRanges{{"a", -2.0, -1.0}}));
    EXPECT_EQ(ranges("a:b: c:0..1"), (ColumnRanges{{"a:b: c", 0.0, 1.0}})) << "the last colon ends the name";
    EXPECT_EQ(ranges("x%3By%25:0.."), (ColumnRanges{{"x;y%", 0.0, {}}}));
    EXPECT_TRUE(ranges("auto").empty());
}

TEST(ColumnRangesWord, SaysWhatIsWrong) {
    for (const char* text :
         {"", "a", "a:1", ":1..2", "a:..", "a:1..x", "a:2..1", "a:1..2;", "a%:1..2", "a%3:1..2", "a:nan..1",
          "a:..inf", "a:1..2;a:1..2;a:1..2;a:1..2;a:1..2", "a:1...2"}) {
        const auto checked = checkWord("filter", text);
        ASSERT_FALSE(checked) << text;
        EXPECT_EQ(checked.error().field, "filter");
        EXPECT_EQ(checked.error().code, ErrorCode::InvalidArgument);
    }
    EXPECT_FALSE(checkWord("filter", std::string(300, 'a') + ":1..2"));
}

TEST(ColumnRangesWord, OfColoursIsTheRestWhateverItIs) {
    View view;
    ASSERT_TRUE(applyWord(view, "color", "column:odd*intensity; #1"));
    EXPECT_EQ(view.style.color, ColorSource::Column);
    EXPECT_EQ(view.style.column, "odd*intensity; #1");
    EXPECT_FALSE(view.style.byIntensity);
    EXPECT_EQ(colorWord(view.style), "column:odd*intensity; #1");
    EXPECT_EQ(applyJson(View(), toJson(view)).value(), view);
    ASSERT_TRUE(applyWord(view, "color", "rgb"));
    EXPECT_EQ(view.style, Style([] {
                  Style style;
                  style.color = ColorSource::Rgb;
                  return style;
              }()))
        << "nothing of the column is left";
    EXPECT_FALSE(checkWord("color", "column:"));
    EXPECT_FALSE(checkWord("color", "columns:a"));
}

TEST(ColumnRangesWord, IsARegionsToo) {
    PointsRegion region;
    EXPECT_TRUE(region.isEverything());
    ASSERT_TRUE(applyRegionWord(region, "filter", "a:1..2"));
    EXPECT_FALSE(region.isEverything());
    EXPECT_EQ(toJson(region),
              nlohmann::json::parse(R"({"filter": [{"column": "a", "low": 1.0, "high": 2.0}]})"));
}

TEST(ColumnRangesWord, HasBothEndsAndNoNaN) {
    const ColumnRange range{"a", -1.0, 2.0};
    EXPECT_TRUE(range.has(-1) && range.has(2) && range.has(0));
    EXPECT_FALSE(range.has(std::nextafter(-1, -2)) || range.has(std::nextafter(2, 3)));
    EXPECT_FALSE(range.has(std::nan("")));
    EXPECT_TRUE((ColumnRange{"a", {}, 2.0}).has(-std::numeric_limits<double>::infinity()));
}

}  // namespace
}  // namespace scancast
