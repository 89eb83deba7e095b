// Access tokens as they travel: in an Authorization header (RFC 6750), or, where a browser cannot set
// headers, in a WebSocket's second subprotocol, as Kubernetes does it. Pure functions; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

inline constexpr std::string_view bearerSubprotocolPrefix = "base64url.bearer.authorization.";
inline constexpr std::size_t shortestToken = 16, longestToken = 1024;

/// A file's or a flag's text as a token: white space around it is dropped. InvalidArgument when what is left
/// is empty, too short to be guessed in vain, too long, or has characters that no header carries.
Expected<std::string> parseToken(std::string_view text);

/// "Bearer abc" → "abc". nullopt for another scheme and for what is no token.
std::optional<std::string> tokenOfAuthorization(std::string_view header);

/// "base64url.bearer.authorization.YWJj" ↔ "abc"; without padding. nullopt for what is none.
std::string bearerSubprotocol(std::string_view token);
std::optional<std::string> tokenOfSubprotocol(std::string_view subprotocol);

}  // namespace scancast
