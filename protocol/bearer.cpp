#include "protocol/bearer.hpp"

#include <algorithm>

#include "protocol/text/base64url.hpp"

namespace scancast {
namespace {

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
    return std::string(bearerSubprotocolPrefix) + base64url(token);
}

std::optional<std::string> tokenOfSubprotocol(std::string_view subprotocol) {
    if (!subprotocol.starts_with(bearerSubprotocolPrefix)) return std::nullopt;
    auto token = fromBase64url(subprotocol.substr(bearerSubprotocolPrefix.size()));
    if (!token || !isToken(*token)) return std::nullopt;
    return token;
}

}  // namespace scancast
