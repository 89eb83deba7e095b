#include "protocol/json_text.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "protocol/nearest_name.hpp"

namespace scancast {
namespace {

std::string nested(int depth) {
    return std::string(depth, '[') + std::string(depth, ']');
}

TEST(JsonText, DepthIsLimited) {
    EXPECT_TRUE(parseJson(nested(maxJsonDepth)));
    const auto deeper = parseJson(nested(maxJsonDepth + 1));
    ASSERT_FALSE(deeper);
    EXPECT_EQ(deeper.error().code, ErrorCode::Malformed);
    EXPECT_NE(deeper.error().message.find("nests deeper than 32"), std::string::npos);
    EXPECT_FALSE(parseJson(std::string(1'000'000, '[')));
    EXPECT_FALSE(parseJson(std::string(1'000'000, '{')));
}

TEST(JsonText, BracketsInStringsAreText) {
    EXPECT_TRUE(parseJson('"' + std::string(100, '[') + '"'));
    EXPECT_TRUE(parseJson(R"({"a": "\"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["})"));
}

TEST(JsonText, WhatIsNoJsonIsMalformed) {
    for (const auto* text :
         {"",         " ",       "{",        "}",           "]",        "{]",         "nul",
          "{\"a\":}", "{'a':1}", "[1,]",     "NaN",         "Infinity", "-",          "1e999",
          "-1e999",   "[1e400]", "\"\x80\"", "\"\\ud800\"", "1 2",      "{\"a\":1}x", "\"\x01\""}) {
        const auto value = parseJson(text);
        ASSERT_FALSE(value) << text;
        EXPECT_EQ(value.error().code, ErrorCode::Malformed) << text;
        EXPECT_NE(value.error().message.find("not JSON: "), std::string::npos) << value.error().message;
        EXPECT_EQ(value.error().message.find("json.exception"), std::string::npos) << value.error().message;
    }
}

TEST(JsonText, AKeyTwiceIsMalformed) {
    EXPECT_TRUE(parseJson(R"([{"a": 1}, {"a": 2, "b": {"a": 3}}])"));
    const auto twice = parseJson(R"({"b": {"a": 1, "c": [{"a": 2}], "a": 3}})");
    ASSERT_FALSE(twice);
    EXPECT_EQ(twice.error().field, "a");
}

TEST(JsonText, LongInputMakesShortMessages) {
    const auto value = parseJson('"' + std::string(60'000, 'x'));
    ASSERT_FALSE(value);
    EXPECT_LT(value.error().message.size(), 300u);
}

TEST(JsonText, PrintingNeverThrows) {
    EXPECT_EQ(printJson("\xff"), "\"\xEF\xBF\xBD\"");
    EXPECT_EQ(printJson(0.1), "0.1");
    EXPECT_EQ(printJson(std::uint64_t{18446744073709551615u}), "18446744073709551615");
}

TEST(NearestName, FindsTyposAndNothingElse) {
    const std::vector<std::string_view> known{"eye", "target", "fov", "viewHeight", "samples", "subsampling"};
    EXPECT_EQ(nearestName("fvo", known), "fov");
    EXPECT_EQ(nearestName("taget", known), "target");
    EXPECT_EQ(nearestName("viewheight", known), "viewHeight");
    EXPECT_EQ(nearestName("view_height", known), "viewHeight");
    EXPECT_EQ(nearestName("sample", known), "samples");
    EXPECT_EQ(nearestName("sub", known), "subsampling");
    EXPECT_EQ(nearestName("zzz", known), "");
    EXPECT_EQ(nearestName("", known), "");
    EXPECT_EQ(nearestName(std::string(100'000, 'f'), known), "");
}

TEST(NearestName, QuotesArePrintableAndShort) {
    EXPECT_EQ(quoteText("a\nb"), "\"a?b\"");
    EXPECT_LT(quoteText(std::string(1000, 'x')).size(), 70u);
    // 30 two-byte characters after one byte: the cut at 60 bytes would fall inside a character.
    std::string umlauts = "x";
    for (int i = 0; i < 40; ++i) umlauts += "ü";
    EXPECT_EQ(printJson(quoteText(umlauts)).find("\xEF\xBF\xBD"), std::string::npos);
}

}  // namespace
}  // namespace scancast
