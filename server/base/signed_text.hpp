// Texts that say in the clear what they are good for, and are signed (HMAC-SHA256): parts between dots, the last of which is
// the signature, as base64url, of all before the last dot. The first part names the kind, so that a text of one kind is never taken
// for one of another, whatever keys they share. Pure functions of outside bytes; any thread. Used by guests' tokens
// (server/access) and those of sessions (server/stream).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scancast {

/// As it is written, and not believed yet.
struct SignedText {
    std::string text;       ///< what is signed
    std::string signature;  ///< as bytes
    /// Compares in constant time.
    bool isSignedWith(std::string_view key) const;
};

std::string withSignature(std::string_view text, std::string_view key);
/// nullopt where what stands behind the last dot is no signature.
std::optional<SignedText> splitSignature(std::string_view text);

/// What stands between its dots.
std::vector<std::string_view> partsOf(std::string_view text);
/// Seconds since 1970, 1 to the year 2255, in one spelling.
std::optional<std::int64_t> secondsOf(std::string_view text);

}  // namespace scancast
