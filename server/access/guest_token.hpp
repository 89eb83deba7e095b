// Guests' tokens: what a link carries, and what a page gets for it. Both say in the clear what they are good for, and are signed
// with a key of the server (HMAC-SHA256), which keeps nothing of them:
//
//   link   scg1.KEY.CLOUD.UNTIL.ID.SIGNATURE
//   pass   scp1.KEY.CLOUD.UNTIL.ID.EXPIRES.SIGNATURE
//
// KEY (the name of the key), CLOUD, ID (12 random bytes) and SIGNATURE as base64url; UNTIL (of the link) and EXPIRES (of the
// pass) in decimal seconds since 1970. What is signed is all before the last dot, so the one is never taken for the other.
// Pure functions of outside bytes; any thread. Used by GuestKeys (guest_keys.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/signed_text.hpp"

namespace scancast {

struct GuestToken {
    std::string key;                        ///< the name of the one that signs
    std::string cloud;                      ///< its id
    std::int64_t until = 0;                 ///< s since 1970: nobody looks by this link from then on
    std::string id;                         ///< of the link, as bytes
    std::optional<std::int64_t> expires{};  ///< of a pass: it is renewed by the link before; a link has none
    bool operator==(const GuestToken&) const = default;
};

inline constexpr std::string_view guestLinkPrefix = "scg1.", guestPassPrefix = "scp1.";
inline constexpr std::size_t guestIdBytes = 12;

/// Whether it means to be one of a guest.
constexpr bool isGuestToken(std::string_view text) {
    return text.starts_with(guestLinkPrefix) || text.starts_with(guestPassPrefix);
}
/// The whole token.
std::string signedToken(const GuestToken& token, std::string_view key);

/// As it is written, and not believed yet.
struct ClaimedGuestToken : SignedText {
    GuestToken token;
};
/// nullopt for everything that signedToken() never writes.
std::optional<ClaimedGuestToken> parseGuestToken(std::string_view text);

/// Whether it can name a cloud (server/catalog): 1 to 80 letters, digits, '.', '_' and '-'.
bool canBeCloudId(std::string_view id);

}  // namespace scancast
