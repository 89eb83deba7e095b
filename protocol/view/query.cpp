#include "protocol/view/query.hpp"

#include "protocol/view/hex_digit.hpp"

namespace scancast {
namespace {

constexpr std::size_t longestQuery = 16 * 1024;

std::string encode(std::string_view text) {
    constexpr std::string_view digits = "0123456789ABCDEF", plain = "-._~,:";
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool safe = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          plain.find(c) != std::string_view::npos;
        if (safe)
            result += c;
        else
            (((result += '%') += digits[byte >> 4u]) += digits[byte & 15u]);
    }
    return result;
}

}  // namespace

Expected<std::string> percentDecode(std::string_view text, std::string_view of) {
    const auto wrong = [&](const char* what) {
        return fail(ErrorCode::InvalidArgument, std::string(of) + what);
    };
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '%') {
            const int high = i + 2 < text.size() ? hexDigit(text[i + 1]) : -1;
            const int low = i + 2 < text.size() ? hexDigit(text[i + 2]) : -1;
            if (high < 0 || low < 0)
                return wrong(
                    " has a % that is not followed by two hexadecimal digits; a literal % is written %25");
            c = static_cast<char>(high * 16 + low);
            i += 2;
        }
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) return wrong(" contains a control character");
        result += c;
    }
    return result;
}

Expected<WordValues> parseQuery(std::string_view query) {
    if (query.size() > longestQuery)
        return fail(ErrorCode::InvalidArgument, "the query is longer than 16 KiB");
    WordValues result;
    while (!query.empty()) {
        const auto end = query.find('&');
        const auto pair = query.substr(0, end);
        query.remove_prefix(end == std::string_view::npos ? query.size() : end + 1);
        if (pair.empty()) continue;
        if (result.size() == mostWords)
            return fail(ErrorCode::InvalidArgument, "the query has more than 256 words");
        const auto equals = pair.find('=');
        const auto word = percentDecode(pair.substr(0, equals), "the query");
        if (!word) return passOn(word);
        const auto value = percentDecode(
            equals == std::string_view::npos ? std::string_view{} : pair.substr(equals + 1), "the query");
        if (!value) return passOn(value);
        result.emplace_back(*word, *value);
    }
    return result;
}

std::string printQuery(const WordValues& given) {
    std::string query;
    for (const auto& [word, value] : given) {
        if (!query.empty()) query += '&';
        query += encode(word) + "=" + encode(value);
    }
    return query;
}

}  // namespace scancast
