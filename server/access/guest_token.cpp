#include "server/access/guest_token.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "protocol/text/base64url.hpp"
#include "server/access/token_file.hpp"

namespace scancast {
namespace {

constexpr std::size_t longestGuestToken = 1024;

}  // namespace

bool canBeCloudId(std::string_view id) {
    return !id.empty() && id.size() <= 80 && std::ranges::all_of(id, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
               c == '_' || c == '-';
    });
}

std::string signedToken(const GuestToken& token, std::string_view key) {
    std::string text(token.expires ? guestPassPrefix : guestLinkPrefix);
    text += fmt::format("{}.{}.{}.{}", base64url(token.key), base64url(token.cloud), token.until,
                        base64url(token.id));
    if (token.expires) text += fmt::format(".{}", *token.expires);
    return withSignature(text, key);
}

std::optional<ClaimedGuestToken> parseGuestToken(std::string_view text) {
    if (text.size() > longestGuestToken) return std::nullopt;
    const bool pass = text.starts_with(guestPassPrefix);
    if (!isGuestToken(text)) return std::nullopt;
    const auto parts = partsOf(text);
    if (parts.size() != (pass ? 7U : 6U)) return std::nullopt;
    const auto key = fromBase64url(parts[1]), cloud = fromBase64url(parts[2]), id = fromBase64url(parts[4]);
    auto split = splitSignature(text);
    const auto until = secondsOf(parts[3]), expires = pass ? secondsOf(parts[5]) : std::nullopt;
    if (!key || !cloud || !id || !split || !until || (pass && !expires)) return std::nullopt;
    if (!isTokenName(*key) || !canBeCloudId(*cloud) || id->size() != guestIdBytes) return std::nullopt;
    return ClaimedGuestToken{std::move(*split), {*key, *cloud, *until, *id, expires}};
}

}  // namespace scancast
