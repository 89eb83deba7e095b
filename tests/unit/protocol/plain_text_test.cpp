#include "protocol/text/plain_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/nearest_name.hpp"
#include "protocol/problem.hpp"
#include "protocol/text/grouped.hpp"

namespace scancast {
namespace {

// "\x1b[2J" clears a screen; "\x1b]0;…\x07" names a window; "\x9b" is "\x1b[" in one character, in UTF-8 "\xC2\x9B".
const std::string clears = "a\x1b[2J\x1b]0;owned\x07\r\b\x7f\xC2\x9B" + std::string(1, '\0') + "b";

TEST(PlainText, ATerminalIsToldNothing) {
    EXPECT_EQ(plainText(clears), "a?[2J?]0;owned??????b");
    // Right-to-left override, isolates, marks, the separators of lines and paragraphs.
    for (const auto* turns : {"\u202E", "\u202A", "\u2066", "\u2069", "\u200F", "\u061C", "\u2028", "\u2029"})
        EXPECT_EQ(plainText("x" + std::string(turns) + "y"), "x?y");
}

TEST(PlainText, WhatIsTextStays) {
    const std::string text = "Köln – 東京 🏛 \u0627\u0644\n\tnext \u00A0\u202F.";
    EXPECT_EQ(plainText(text), text);
    EXPECT_EQ(plainText(""), "");
    EXPECT_EQ(plainText(plainText(clears)), plainText(clears));
}

TEST(PlainText, BytesThatAreNoUtf8AreNotTrusted) {
    // A lone continuation, an overlong escape, a surrogate, beyond U+10FFFF, cut short.
    for (const auto& [bytes, plain] :
         std::vector<std::pair<std::string, std::string>>{{"\x9b"
                                                           "2J",
                                                           "?2J"},
                                                          {"\xC0\x9B", "??"},
                                                          {"\xE0\x80\x9B", "???"},
                                                          {"\xED\xA0\x80", "???"},
                                                          {"\xF4\x90\x80\x80", "????"},
                                                          {"\xF8", "?"},
                                                          {"é\xC3", "é?"},
                                                          {"\xE6\x9D", "??"}})
        EXPECT_EQ(plainText(bytes), plain) << plain;
}

TEST(PlainText, NobodyWritesTheNextLineOfALog) {
    EXPECT_EQ(plainLine("town\n12:00:00 error: all is lost\r\n\tx"), "town 12:00:00 error: all is lost?  x");
}

TEST(PlainText, JsonMeansTheSameAndIsPlain) {
    const std::string title = clears + "\u202E é 東京 \n";
    const std::string text = printJson({{"title", title}});
    EXPECT_EQ(plainText(text), text) << "nothing in it that is not plain";
    EXPECT_EQ(parseJson(text)->at("title"), title) << "and nothing lost";
    EXPECT_NE(text.find("é 東京"), std::string::npos);
    EXPECT_EQ(plainJson("{\n  \"a\": \"\x7f\"\n}"), "{\n  \"a\": \"\\u007f\"\n}");
}

TEST(PlainText, QuotesAndProblemsAreLines) {
    EXPECT_EQ(quoteText("a\xC2\x9B\x1b[2Jb"), "\"a??[2Jb\"");
    Problem problem;
    problem.detail = clears;
    EXPECT_EQ(errorOf(problem).message, plainText(clears));
    problem.detail.clear();
    problem.title = "\x1b[2J";
    EXPECT_EQ(errorOf(problem).message, "?[2J");
    problem.requestId = "a\n\x1b[2Jb";
    EXPECT_EQ(errorOf(problem).message, "?[2J (request a ?[2Jb)");
}

TEST(Grouped, InThrees) {
    EXPECT_EQ(counted(0, "point"), "0 points");
    EXPECT_EQ(counted(1, "point"), "1 point");
    EXPECT_EQ(counted(20000, "node"), "20000 nodes");
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1000), "1,000");
    EXPECT_EQ(grouped(12345678), "12,345,678");
    EXPECT_EQ(grouped(~0ULL), "18,446,744,073,709,551,615");
}

}  // namespace
}  // namespace scancast
