#include "server/access/guest_token.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "protocol/text/base64url.hpp"
#include "server/access/token_file.hpp"

namespace scancast {
namespace {

constexpr std::size_t longestGuestToken = 1024, signatureBytes = 32;
/// Far off, and no further than the system's clock counts nanoseconds.
constexpr std::int64_t endOfTime = 9'000'000'000;

std::string signatureOf(std::string_view text, std::string_view key) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
    unsigned int size = 0;
    HMAC(EVP_sha256(), key.data(), int(key.size()), reinterpret_cast<const unsigned char*>(text.data()),
         text.size(), bytes.data(), &size);
    return {reinterpret_cast<const char*>(bytes.data()), size};
}

std::optional<std::int64_t> secondsOf(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value <= 0 || value > endOfTime ||
        text.front() == '0')
        return std::nullopt;
    return value;
}

std::vector<std::string_view> partsOf(std::string_view text) {
    std::vector<std::string_view> parts;
    while (true) {
        const auto dot = text.find('.');
        parts.push_back(text.substr(0, dot));
        if (dot == std::string_view::npos) return parts;
        text.remove_prefix(dot + 1);
    }
}

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
    const std::string signature = base64url(signatureOf(text, key));
    return fmt::format("{}.{}", text, signature);
}

bool ClaimedGuestToken::isSignedWith(std::string_view key) const {
    const std::string right = signatureOf(text, key);
    return signature.size() == right.size() &&
           CRYPTO_memcmp(signature.data(), right.data(), right.size()) == 0;
}

std::optional<ClaimedGuestToken> parseGuestToken(std::string_view text) {
    if (text.size() > longestGuestToken) return std::nullopt;
    const bool pass = text.starts_with(guestPassPrefix);
    if (!isGuestToken(text)) return std::nullopt;
    const auto parts = partsOf(text);
    if (parts.size() != (pass ? 7U : 6U)) return std::nullopt;
    const auto key = fromBase64url(parts[1]), cloud = fromBase64url(parts[2]), id = fromBase64url(parts[4]),
               signature = fromBase64url(parts.back());
    const auto until = secondsOf(parts[3]), expires = pass ? secondsOf(parts[5]) : std::nullopt;
    if (!key || !cloud || !id || !signature || !until || (pass && !expires)) return std::nullopt;
    if (!isTokenName(*key) || !canBeCloudId(*cloud) || id->size() != guestIdBytes ||
        signature->size() != signatureBytes)
        return std::nullopt;
    return ClaimedGuestToken{
        {*key, *cloud, *until, *id, expires}, std::string(text.substr(0, text.rfind('.'))), *signature};
}

}  // namespace scancast
