// Numbers of texts, to the last bit. Oracle: strtod() and std::from_chars(), which round correctly.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "renderer/cloud/import/text/text_fields.hpp"
#include "tests/support/sized.hpp"

namespace scancast {
namespace {

/// The same value to the bit, and as much of the text.
::testing::AssertionResult sameAsFromChars(const std::string& text) {
    const char* const begin = text.data();
    const char* const end = begin + text.size();
    double wanted = 0, got = 0;
    const auto [behind, problem] = std::from_chars(begin, end, wanted);
    const char* at = begin;
    const bool read = readNumber(at, end, got);
    if (read != (problem == std::errc())) return ::testing::AssertionFailure() << text << ": read " << read;
    if (at != behind) return ::testing::AssertionFailure() << text << ": ends at " << at - begin;
    if (read && std::bit_cast<std::uint64_t>(wanted) != std::bit_cast<std::uint64_t>(got))
        return ::testing::AssertionFailure() << text << ": " << got << " instead of " << wanted;
    return ::testing::AssertionSuccess();
}

TEST(TextNumbers, AreStrtodsForWhatSurveysWrite) {
    std::mt19937_64 random(3);
    std::array<char, 64> text{};
    for (int i = 0; i < test::sized(300'000, 10'000); ++i) {
        const double value = (double(random()) / 0x1p64 - 0.5) * std::pow(10.0, double(random() % 16) - 4);
        const int length = std::snprintf(text.data(), text.size(), "%.*f", int(random() % 18), value);
        const char* at = text.data();
        double got = 0;
        ASSERT_TRUE(readNumber(at, text.data() + length, got)) << text.data();
        ASSERT_EQ(at, text.data() + length) << text.data();
        ASSERT_EQ(std::bit_cast<std::uint64_t>(got),
                  std::bit_cast<std::uint64_t>(std::strtod(text.data(), nullptr)))
            << text.data();
    }
}

TEST(TextNumbers, AreFromCharssForAnyTextAtAll) {
    std::mt19937 random(4);
    constexpr std::string_view letters = "0123456789012345678901234567890123456789...--eE+ nx,";
    for (int i = 0; i < test::sized(300'000, 20'000); ++i) {
        std::string text(random() % 28, ' ');
        for (char& c : text) c = letters[random() % letters.size()];
        if (text.starts_with('+')) continue;  // a plus sign is ours
        ASSERT_TRUE(sameAsFromChars(text));
    }
}

TEST(TextNumbers, AreRightWhereOneWayEndsAndTheOtherBegins) {
    for (const char* text : {"",
                             ".",
                             "-",
                             "-.",
                             "0",
                             "-0",
                             "-0.0",
                             "1.",
                             ".5",
                             "-.5",
                             "9007199254740992",
                             "9007199254740993",
                             "9007199254740991.5",
                             "900719925474099.25",
                             "0.9007199254740993",
                             "1234567890123456789",
                             "12345678901234567890",
                             "99999999999999999999999",
                             "0.0000000000000000001",
                             "0.00000000000000000001",
                             "0000000000000000000000001.5",
                             "1e5",
                             "1E5",
                             "1e",
                             "1ex",
                             "1.5e-300",
                             "1e999",
                             "1e-999",
                             "nan",
                             "inf",
                             "-inf",
                             "infinity",
                             "0x10",
                             "1.2.3",
                             "1-2",
                             "1,5",
                             "4.9e-324",
                             "179769313486231570000"})
        EXPECT_TRUE(sameAsFromChars(text));
}

TEST(TextNumbers, MayHaveAPlusSignAndOneSignAlone) {
    for (const auto& [text, ok] :
         {std::pair("+1.5", true), {"+-1", false}, {"--1", false}, {"++1", false}, {"+", false}}) {
        const char* at = text;
        double value = 0;
        EXPECT_EQ(readNumber(at, text + std::string_view(text).size(), value), ok) << text;
    }
}

}  // namespace
}  // namespace scancast
