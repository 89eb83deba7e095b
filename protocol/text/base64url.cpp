#include "protocol/text/base64url.hpp"

#include <cstdint>

namespace scancast {
namespace {

constexpr std::string_view base64Digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

}  // namespace

std::string base64url(std::string_view bytes) {
    std::string text;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : bytes) {
        bits = bits << 8 | static_cast<unsigned char>(c);
        for (count += 8; count >= 6; count -= 6) text.push_back(base64Digits[bits >> (count - 6) & 63]);
    }
    if (count > 0) text.push_back(base64Digits[bits << (6 - count) & 63]);
    return text;
}

std::optional<std::string> fromBase64url(std::string_view text) {
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const auto digit = base64Digits.find(c);
        if (digit == std::string_view::npos) return std::nullopt;
        bits = bits << 6 | std::uint32_t(digit);
        if ((count += 6) < 8) continue;
        count -= 8;
        bytes.push_back(char(bits >> count & 255));
    }
    if (count >= 6 || (bits & ((1U << count) - 1)) != 0) return std::nullopt;
    return bytes;
}

}  // namespace scancast
