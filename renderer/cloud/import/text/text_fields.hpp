// A line of numbers, cut into fields. Pure functions; the inner loop of reading text.
// Pipeline: bytes → lines → **fields** → points.
#pragma once

#include <charconv>
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

inline const char* skipBlanks(const char* at, const char* end) {
    while (at != end && isBlank(*at)) ++at;
    return at;
}

/// The number at `at`; `at` moves behind it. As std::from_chars, and a plus sign: "nan" and "inf" are numbers
/// (no coordinates, though), 1e999 is none.
inline bool readNumber(const char*& at, const char* end, double& value) {
    const char* from = at;
    if (from != end && *from == '+' && ++from != end && *from == '-') return false;
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
