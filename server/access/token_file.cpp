#include "server/access/token_file.hpp"

#include <fmt/format.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>

#include "protocol/bearer.hpp"
#include "protocol/text/base64url.hpp"
#include "server/access/token_strength.hpp"
#include "transport/secret_file.hpp"

namespace scancast {
namespace {

constexpr std::size_t longestName = 64;
constexpr std::size_t longestFile = 256 * 1024;
constexpr std::string_view whiteSpace = " \t\r\n";

std::vector<std::string_view> wordsOf(std::string_view line) {
    std::vector<std::string_view> words;
    while (true) {
        const auto begin = line.find_first_not_of(whiteSpace);
        if (begin == std::string_view::npos) return words;
        line.remove_prefix(begin);
        words.push_back(line.substr(0, line.find_first_of(whiteSpace)));
        line.remove_prefix(words.back().size());
    }
}

/// What is wrong is said without the line: a token may stand anywhere in it.
Expected<NamedToken> parseLine(const std::vector<std::string_view>& words, std::string_view usual) {
    if (words.size() > 2) {
        return fail(ErrorCode::InvalidArgument,
                    "a line is NAME TOKEN, or one token alone; there are more words on this one");
    }
    NamedToken line{std::string(words.size() == 2 ? words.front() : usual), {}};
    if (!isTokenName(line.name)) return fail(ErrorCode::InvalidArgument, tokenNameRule());
    auto token = parseToken(words.back());
    if (!token) return passOn(std::move(token));
    line.token = std::move(*token);
    if (const double bits = estimatedBits(line.token); bits < leastTokenBits)
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("the token \"{}\" is too weak, {}", line.name, weaknessText(bits)));
    return line;
}

Expected<void> addTo(std::vector<NamedToken>& tokens, NamedToken line) {
    for (const NamedToken& other : tokens) {
        if (other.name == line.name)
            return fail(ErrorCode::InvalidArgument,
                        fmt::format("a second token of the name \"{}\"; give each line a name of its own: "
                                    "NAME TOKEN",
                                    line.name));
        if (other.token == line.token)
            return fail(ErrorCode::InvalidArgument,
                        fmt::format("the tokens of \"{}\" and \"{}\" are the same, so that neither could be "
                                    "withdrawn alone; make another one",
                                    other.name, line.name));
    }
    tokens.push_back(std::move(line));
    return {};
}

}  // namespace

bool isTokenName(std::string_view name) {
    return !name.empty() && name.size() <= longestName && std::ranges::all_of(name, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
               c == '_' || c == '-';
    });
}

std::string tokenNameRule() {
    return fmt::format("a name has 1 to {} letters, digits, '.', '_' and '-'", longestName);
}

Expected<std::vector<NamedToken>> parseTokens(std::string_view text, std::string_view usual,
                                              const std::string& source) {
    std::vector<NamedToken> tokens;
    for (int number = 1; !text.empty(); ++number) {
        const auto end = text.find('\n');
        const auto words = wordsOf(text.substr(0, end));
        text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
        if (words.empty() || words.front().starts_with('#')) continue;
        auto line = parseLine(words, usual);
        const auto added = line ? addTo(tokens, std::move(*line)) : Expected<void>(passOn(std::move(line)));
        if (!added)
            return fail(added.error().code, fmt::format("{}:{}: {}.", source, number, added.error().message));
    }
    if (tokens.empty())
        return fail(ErrorCode::InvalidArgument,
                    source + ": there is no token in it; \"scancast token NAME\" makes a line with one.");
    return tokens;
}

Expected<std::vector<NamedToken>> readTokens(const std::filesystem::path& path, std::string_view usual) {
    const auto text = readSecretFile(path, longestFile);
    if (!text) return passOn(text);
    return parseTokens(*text, usual, path.string());
}

Expected<std::string> newToken() {
    std::array<char, 32> bytes{};
    if (RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), int(bytes.size())) != 1)
        return fail(ErrorCode::Io, "The system has no random numbers to give; try again.");
    return base64url({bytes.data(), bytes.size()});
}

}  // namespace scancast
