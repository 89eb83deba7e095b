// Bytes as text that a URL, a header and a file's line carry as it is: base64url without padding (RFC 4648, 5).
// Pure functions; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scancast {

std::string base64url(std::string_view bytes);
/// nullopt for other characters, and for what base64url() never makes: padding, a digit too many, bits that are
/// left over and not 0. So each text stands for its own bytes alone.
std::optional<std::string> fromBase64url(std::string_view text);

}  // namespace scancast
