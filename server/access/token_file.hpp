// Files that hold the secrets of `serve`: several named tokens, or keys that sign guests' links. Free functions; any thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

struct NamedToken {
    std::string name;   ///< for logs: [A-Za-z0-9._-]{1,64}
    std::string token;  ///< the secret
    bool operator==(const NamedToken&) const = default;
};

bool isTokenName(std::string_view name);
/// "a name has 1 to 64 letters, digits, '.', '_' and '-'": what is wrong with one that is none.
std::string tokenNameRule();

/// A line each, `NAME TOKEN`; one of them may be a token alone, which is called `usual`. Empty lines and those that begin
/// with # are skipped. InvalidArgument for what is none, for a name or a token that stands there twice, for a token that
/// could be guessed (token_strength.hpp) and for a text without any: names `source` and the line, never a token.
Expected<std::vector<NamedToken>> parseTokens(std::string_view text, std::string_view usual,
                                              const std::string& source);

/// What that file holds, which nobody else may read or change (transport/secret_file.hpp).
Expected<std::vector<NamedToken>> readTokens(const std::filesystem::path& path, std::string_view usual);

/// 256 random bits as base64url. Io when the system has no random numbers to give.
Expected<std::string> newToken();

}  // namespace scancast
