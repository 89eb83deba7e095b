#include "server/base/signed_text.hpp"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <array>
#include <charconv>

#include "protocol/text/base64url.hpp"

namespace scancast {
namespace {

constexpr std::size_t signatureBytes = 32;
/// Far off, and no further than the system's clock counts nanoseconds.
constexpr std::int64_t endOfTime = 9'000'000'000;

std::string signatureOf(std::string_view text, std::string_view key) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
    unsigned int size = 0;
    HMAC(EVP_sha256(), key.data(), int(key.size()), reinterpret_cast<const unsigned char*>(text.data()),
         text.size(), bytes.data(), &size);
    return {reinterpret_cast<const char*>(bytes.data()), size};
}

}  // namespace

bool SignedText::isSignedWith(std::string_view key) const {
    const std::string right = signatureOf(text, key);
    return signature.size() == right.size() &&
           CRYPTO_memcmp(signature.data(), right.data(), right.size()) == 0;
}

std::string withSignature(std::string_view text, std::string_view key) {
    return std::string(text) + "." + base64url(signatureOf(text, key));
}

std::optional<SignedText> splitSignature(std::string_view text) {
    const auto dot = text.rfind('.');
    if (dot == std::string_view::npos) return std::nullopt;
    auto signature = fromBase64url(text.substr(dot + 1));
    if (!signature || signature->size() != signatureBytes) return std::nullopt;
    return SignedText{std::string(text.substr(0, dot)), std::move(*signature)};
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

std::optional<std::int64_t> secondsOf(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value <= 0 || value > endOfTime ||
        text.front() == '0')
        return std::nullopt;
    return value;
}

}  // namespace scancast
