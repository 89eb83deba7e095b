#include "server/net/log/request_ids.hpp"

#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>

namespace scancast {
namespace {

constexpr std::size_t longestId = 64;
constexpr std::size_t traceDigits = 32, parentDigits = 16;

bool isDecimal(char c) {
    return c >= '0' && c <= '9';
}

/// Lower case alone, as the recommendation has it.
bool isHex(std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return isDecimal(c) || (c >= 'a' && c <= 'f'); });
}

bool isZero(std::string_view text) {
    return text.find_first_not_of('0') == std::string_view::npos;
}

template <std::size_t bytes>
std::string randomHex() {
    std::array<std::uint8_t, bytes> random{};
    if (RAND_bytes(random.data(), int(bytes)) != 1)
        throw std::runtime_error("there are no random numbers for a request's id");
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : random) {
        text += digits[byte >> 4u];
        text += digits[byte & 15u];
    }
    return text;
}

}  // namespace

bool isRequestId(std::string_view text) {
    return !text.empty() && text.size() <= longestId && std::ranges::all_of(text, [](char c) {
        return isDecimal(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '_' ||
               c == '-';
    });
}

// 00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01
std::optional<TraceParent> parseTraceParent(std::string_view text) {
    constexpr std::size_t length = 2 + 1 + traceDigits + 1 + parentDigits + 1 + 2;
    if (text.size() < length) return std::nullopt;
    const std::string_view version = text.substr(0, 2), trace = text.substr(3, traceDigits),
                           parent = text.substr(3 + traceDigits + 1, parentDigits),
                           flags = text.substr(length - 2, 2);
    for (const std::size_t dash : {std::size_t(2), 3 + traceDigits, length - 3})
        if (text[dash] != '-') return std::nullopt;
    if (!isHex(version) || !isHex(trace) || !isHex(parent) || !isHex(flags)) return std::nullopt;
    if (version == "ff" || isZero(trace) || isZero(parent)) return std::nullopt;
    if (text.size() > length && (version == "00" || text[length] != '-')) return std::nullopt;
    const char last = flags[1];
    const int bits = isDecimal(last) ? last - '0' : last - 'a' + 10;
    return TraceParent{std::string(trace), std::string(parent), (bits & 1) != 0};
}

RequestIds RequestIds::of(std::string_view requestId, std::string_view traceParent) {
    RequestIds ids;
    ids.request = isRequestId(requestId) ? std::string(requestId) : randomHex<16>();
    ids.trace = parseTraceParent(traceParent);
    if (ids.trace) ids.span = randomHex<parentDigits / 2>();
    return ids;
}

}  // namespace scancast
