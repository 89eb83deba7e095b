// The `resume` token of a session: what any server with the same key believes, without having heard of the session before.
//
//   scs1.SESSION.TURN.EXPIRES.OWNER.NONCE.SIGNATURE
//
// SESSION is the session's id; TURN, in decimal, counts the connections that it has had; EXPIRES, in decimal seconds since 1970;
// OWNER a digest of who may come with it; NONCE 12 random bytes; these two and SIGNATURE as base64url. It does not hold what is
// seen: the client knows that, and says it in its hello (docs/decisions/027-tokens-any-replica-believes.md). Pure functions of
// outside bytes; any thread. Used by ResumeStore (resume_store.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/signed_text.hpp"

namespace scancast {

struct SessionToken {
    std::string session;
    std::uint32_t turn = 1;    ///< 1 of the connection that the session began with
    std::int64_t expires = 0;  ///< s since 1970: good for nothing from then on
    std::string owner;         ///< ownerDigest()
    std::string nonce;         ///< as bytes
    bool operator==(const SessionToken&) const = default;
};

inline constexpr std::string_view sessionTokenPrefix = "scs1.";
inline constexpr std::size_t sessionNonceBytes = 12, sessionOwnerBytes = 16;
inline constexpr std::uint32_t lastTurn = 1'000'000'000;

/// Of who came with the first hello; the same text gives the same digest everywhere.
std::string ownerDigest(std::string_view who);
/// The whole token.
std::string signedToken(const SessionToken& token, std::string_view key);

/// As it is written, and not believed yet.
struct ClaimedSessionToken : SignedText {
    SessionToken token;
};
/// nullopt for everything that signedToken() never writes.
std::optional<ClaimedSessionToken> parseSessionToken(std::string_view text);

}  // namespace scancast
