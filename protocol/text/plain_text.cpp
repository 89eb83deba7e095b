#include "protocol/text/plain_text.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace scancast {
namespace {

struct Character {
    std::size_t bytes = 1;
    bool whole = false;  ///< else a byte that is no UTF-8
    std::uint32_t code = 0;
};

/// The first character of what is not empty: shortest form, no surrogates, up to U+10FFFF.
Character firstOf(std::string_view text) {
    const auto at = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
    const std::uint32_t lead = at(0);
    if (lead < 0x80) return {1, true, lead};
    const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
    std::uint32_t code = lead & (0x7Fu >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((at(i) & 0xC0u) != 0x80) return {};
        code = code << 6u | (at(i) & 0x3Fu);
    }
    constexpr std::array<std::uint32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
    if (code < least[bytes] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000)) return {};
    return {bytes, true, code};
}

bool isPlain(std::uint32_t code) {
    const auto within = [code](std::uint32_t first, std::uint32_t last) {
        return code >= first && code <= last;
    };
    if (code < 0x20) return code == '\n' || code == '\t';
    return !within(0x7F, 0x9F) && code != 0x061C && !within(0x200E, 0x200F) && !within(0x2028, 0x202E) &&
           !within(0x2066, 0x2069);
}

/// `instead` is given each character that is not plain, and appends what stands in its place.
template <class Instead>
std::string replaced(std::string_view text, Instead instead) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const Character c = firstOf(text);
        if (c.whole && isPlain(c.code))
            result += text.substr(0, c.bytes);
        else
            instead(result, c);
        text.remove_prefix(c.bytes);
    }
    return result;
}

}  // namespace

std::string plainText(std::string_view text) {
    return replaced(text, [](std::string& result, const Character&) { result += '?'; });
}

std::string plainLine(std::string_view text) {
    std::string line = plainText(text);
    std::ranges::replace_if(
        line, [](char c) { return c == '\n' || c == '\t'; }, ' ');
    return line;
}

std::string plainJson(std::string json) {
    // Most texts are ASCII without DEL, and stay as they are.
    if (std::ranges::all_of(json, [](char c) { return isPlain(static_cast<std::uint8_t>(c)) && c > 0; }))
        return json;
    return replaced(json, [](std::string& result, const Character& c) {
        constexpr std::string_view digits = "0123456789abcdef";
        const std::uint32_t code = c.whole ? c.code : 0xFFFD;  // no UTF-8 was no JSON
        result += "\\u";
        for (unsigned shift = 16; shift > 0; shift -= 4) result += digits[code >> (shift - 4) & 0xFu];
    });
}

}  // namespace scancast
