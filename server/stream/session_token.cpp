#include "server/stream/session_token.hpp"

#include <fmt/format.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>

#include "protocol/text/base64url.hpp"

namespace scancast {
namespace {

constexpr std::size_t longestSessionToken = 256, longestSessionId = 64;

bool canBeSessionId(std::string_view id) {
    return !id.empty() && id.size() <= longestSessionId &&
           std::ranges::all_of(id, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); });
}

}  // namespace

std::string ownerDigest(std::string_view who) {
    std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
    SHA256(reinterpret_cast<const unsigned char*>(who.data()), who.size(), digest.data());
    return {reinterpret_cast<const char*>(digest.data()), sessionOwnerBytes};
}

std::string signedToken(const SessionToken& token, std::string_view key) {
    return withSignature(fmt::format("{}{}.{}.{}.{}.{}", sessionTokenPrefix, token.session, token.turn,
                                     token.expires, base64url(token.owner), base64url(token.nonce)),
                         key);
}

std::optional<ClaimedSessionToken> parseSessionToken(std::string_view text) {
    if (text.size() > longestSessionToken || !text.starts_with(sessionTokenPrefix)) return std::nullopt;
    const auto parts = partsOf(text);
    if (parts.size() != 7 || !canBeSessionId(parts[1])) return std::nullopt;
    const auto turn = secondsOf(parts[2]), expires = secondsOf(parts[3]);
    const auto owner = fromBase64url(parts[4]), nonce = fromBase64url(parts[5]);
    auto split = splitSignature(text);
    if (!turn || *turn > lastTurn || !expires || !owner || !nonce || !split) return std::nullopt;
    if (owner->size() != sessionOwnerBytes || nonce->size() != sessionNonceBytes) return std::nullopt;
    return ClaimedSessionToken{std::move(*split),
                               {std::string(parts[1]), std::uint32_t(*turn), *expires, *owner, *nonce}};
}

}  // namespace scancast
