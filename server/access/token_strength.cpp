#include "server/access/token_strength.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace scancast {
namespace {

bool isLower(char c) {
    return c >= 'a' && c <= 'z';
}
bool isUpper(char c) {
    return c >= 'A' && c <= 'Z';
}
bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

/// Of how many characters this one seems to be drawn from.
double alphabetOf(std::string_view token) {
    const auto all = [&](auto&& is) { return std::ranges::all_of(token, is); };
    if (all(isDigit)) return 10;
    if (all([](char c) { return isDigit(c) || (c >= 'a' && c <= 'f'); })) return 16;
    if (all([](char c) { return isDigit(c) || (c >= 'A' && c <= 'F'); })) return 16;
    const auto any = [&](auto&& is) { return std::ranges::any_of(token, is); };
    const bool others = any([](char c) { return !isDigit(c) && !isLower(c) && !isUpper(c); });
    return (any(isLower) ? 26 : 0) + (any(isUpper) ? 26 : 0) + (any(isDigit) ? 10 : 0) + (others ? 32 : 0);
}

/// Which characters stand in four and more that stood in the same order before. Tokens are short: compared pair by pair.
std::vector<bool> repeated(std::string_view token) {
    constexpr std::size_t least = 4;
    std::vector<bool> marks(token.size());
    for (std::size_t at = 1; at + least <= token.size(); ++at) {
        const std::string_view four = token.substr(at, least);
        if (token.substr(0, at + least - 1).find(four) == std::string_view::npos) continue;
        std::fill_n(marks.begin() + std::ptrdiff_t(at), least, true);
    }
    return marks;
}

bool inARun(std::string_view token, std::size_t at) {
    if (at < 2) return false;
    const int step = token[at] - token[at - 1];
    return step >= -1 && step <= 1 && step == token[at - 1] - token[at - 2];
}

bool likeAWord(std::string_view token, std::size_t at) {
    if (at == 0) return false;
    return (isLower(token[at]) && isLower(token[at - 1])) || (isUpper(token[at]) && isUpper(token[at - 1]));
}

}  // namespace

double estimatedBits(std::string_view token) {
    if (token.empty()) return 0;
    const std::set<char> different(token.begin(), token.end());
    const double alphabet = alphabetOf(token);
    const double each = std::log2(std::min(alphabet, 2.0 * double(different.size())));
    const bool mayHaveWords = alphabet > 16;
    const std::vector<bool> before = repeated(token);
    double bits = 0;
    for (std::size_t at = 0; at < token.size(); ++at) {
        if (before[at] || inARun(token, at)) continue;
        bits += mayHaveWords && likeAWord(token, at) ? std::min(2.0, each) : each;
    }
    return bits;
}

std::string weaknessText(double bits) {
    return fmt::format(
        "it could be guessed: about {:.0f} bits are estimated, and {:.0f} are needed. \"scancast token "
        "NAME\" "
        "makes a line with a good one, and so does: openssl rand -base64 32",
        std::floor(bits), leastTokenBits);
}

}  // namespace scancast
