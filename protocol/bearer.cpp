#include "protocol/bearer.hpp"

#include <algorithm>
#include <cstdint>

namespace scancast {
namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr std::string_view white = " \t\r\n";

bool isVisible(char c) {
    return c > ' ' && c <= '~';
}

bool isToken(std::string_view text) {
    return !text.empty() && text.size() <= longestToken && std::all_of(text.begin(), text.end(), isVisible);
}

std::string_view trim(std::string_view text) {
    const auto begin = text.find_first_not_of(white);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(white) - begin + 1);
}

}  // namespace

Expected<std::string> parseToken(std::string_view text) {
    const std::string_view token = trim(text);
    if (token.empty()) return fail(ErrorCode::InvalidArgument, "there is no token in it");
    if (token.size() < shortestToken) {
        return fail(
            ErrorCode::InvalidArgument,
            "a token needs at least " + std::to_string(shortestToken) +
                " characters, or it could be guessed; head -c 32 /dev/urandom | base64 makes a good one");
    }
    if (token.size() > longestToken) {
        return fail(ErrorCode::InvalidArgument,
                    "a token has at most " + std::to_string(longestToken) + " characters");
    }
    if (!isToken(token)) {
        return fail(ErrorCode::InvalidArgument,
                    "a token is one word of letters, digits and ASCII signs, without white space");
    }
    return std::string(token);
}

std::optional<std::string> tokenOfAuthorization(std::string_view header) {
    constexpr std::string_view scheme = "bearer ";
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    if (header.size() < scheme.size() ||
        !std::equal(scheme.begin(), scheme.end(), header.begin(),
                    [&](char wanted, char given) { return wanted == lower(given); })) {
        return std::nullopt;
    }
    const std::string_view token = trim(header.substr(scheme.size()));
    if (!isToken(token)) return std::nullopt;
    return std::string(token);
}

std::string bearerSubprotocol(std::string_view token) {
    std::string text(bearerSubprotocolPrefix);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : token) {
        bits = bits << 8 | static_cast<unsigned char>(c);
        for (count += 8; count >= 6; count -= 6) text.push_back(alphabet[bits >> (count - 6) & 63]);
    }
    if (count > 0) text.push_back(alphabet[bits << (6 - count) & 63]);
    return text;
}

std::optional<std::string> tokenOfSubprotocol(std::string_view subprotocol) {
    if (!subprotocol.starts_with(bearerSubprotocolPrefix)) return std::nullopt;
    std::string token;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : subprotocol.substr(bearerSubprotocolPrefix.size())) {
        const auto digit = alphabet.find(c);
        if (digit == std::string_view::npos) return std::nullopt;
        bits = bits << 6 | std::uint32_t(digit);
        if ((count += 6) < 8) continue;
        count -= 8;
        token.push_back(char(bits >> count & 255));
    }
    if (!isToken(token)) return std::nullopt;
    return token;
}

}  // namespace scancast
