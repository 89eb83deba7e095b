// A line of numbers, cut into fields. Pure functions; the inner loop of reading text.
// Pipeline: bytes → lines → **fields** → points.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace scancast {

/// What stands between two fields. Blanks and tabs may stand beside any of them.
struct Separator {
    char mark = ' ';            ///< ' ' = blanks and tabs alone, ',' or ';'
    bool decimalComma = false;  ///< 1,5 is one and a half; only with ';' or blanks
    bool operator==(const Separator&) const = default;
};

inline bool isBlank(char c) {
    return c == ' ' || c == '\t';
}

inline bool isDigit(char c) {
    return static_cast<unsigned char>(c - '0') < 10;
}

/// Those that doubles hold exactly and 19 digits need.
inline constexpr double powersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,
                                         1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19};

inline const char* skipBlanks(const char* at, const char* end) {
    while (at != end && isBlank(*at)) ++at;
    return at;
}

/// The number at `at`; `at` moves behind it. As std::from_chars, and a plus sign: "nan" and "inf" are numbers
/// (no coordinates, though), 1e999 is none.
inline bool readNumber(const char*& at, const char* end, double& value) {
    const char* from = at;
    if (from != end && *from == '+' && ++from != end && *from == '-') return false;
    // What surveys write, digits with a point among them, is exact as an integer and a power of ten, and their quotient is
    // rounded once: the number that from_chars() finds, too (Clinger, How to read floating point numbers accurately, 1990).
    // What is longer, or has an exponent, is left to it.
    const char* digit = from;
    const bool negative = digit != end && *digit == '-';
    digit += negative;
    std::uint64_t mantissa = 0;
    const char* const first = digit;
    for (; digit != end && isDigit(*digit); ++digit) mantissa = mantissa * 10 + std::uint64_t(*digit - '0');
    std::ptrdiff_t digits = digit - first, decimals = 0;
    if (digit != end && *digit == '.') {
        const char* const point = ++digit;
        for (; digit != end && isDigit(*digit); ++digit)
            mantissa = mantissa * 10 + std::uint64_t(*digit - '0');
        decimals = digit - point;
        digits += decimals;
    }
    // 19 digits do not overflow; 2^53 is the last integer up to which all are doubles.
    if (digits > 0 && digits <= 19 && mantissa <= std::uint64_t(1) << 53 &&
        (digit == end || (*digit != 'e' && *digit != 'E'))) {
        const double number = static_cast<double>(mantissa) / powersOfTen[decimals];
        value = negative ? -number : number;
        at = digit;
        return true;
    }
    const auto [behind, problem] = std::from_chars(from, end, value);
    at = behind;
    return problem == std::errc();
}

/// A whole field as a number, blanks aside; nullopt for everything else.
std::optional<double> numberIn(std::string_view field, bool decimalComma = false);

/// The fields of a line, without the blanks around them. A separator that ends the line ends its last field.
/// Quotation marks around a field go away.
void splitFields(std::string_view line, Separator separator, std::vector<std::string_view>& fields);

/// What separates the fields of these lines, which hold numbers (or names).
Separator separatorOf(std::span<const std::string_view> lines);

/// A line that says nothing about points: empty, or a comment (# or //, after blanks).
inline bool isComment(std::string_view line) {
    const char* end = line.data() + line.size();
    const char* at = skipBlanks(line.data(), end);
    return at == end || *at == '#' || (*at == '/' && at + 1 != end && at[1] == '/');
}

}  // namespace scancast
