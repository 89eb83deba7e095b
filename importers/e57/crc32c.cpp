#include "importers/e57/crc32c.hpp"

#include <array>

#include "files/bytes.hpp"

#if defined(__x86_64__)
#include <nmmintrin.h>
#endif

namespace scancast::import_e57 {

namespace {

constexpr std::array<std::uint32_t, 256> makeTable() {
    constexpr std::uint32_t reflectedPolynomial = 0x82f63b78;
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t value = i;
        for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) != 0 ? reflectedPolynomial : 0);
        table[i] = value;
    }
    return table;
}
constexpr auto crcTable = makeTable();

#if defined(__x86_64__)
__attribute__((target("sse4.2"))) std::uint32_t crc32cByInstruction(std::span<const std::byte> bytes) {
    std::uint64_t value = 0xffffffff;
    const auto* at = bytes.data();
    auto left = bytes.size();
    for (; left >= 8; left -= 8, at += 8) value = _mm_crc32_u64(value, loadLe<std::uint64_t>(at));
    auto rest = static_cast<std::uint32_t>(value);
    for (; left > 0; --left, ++at) rest = _mm_crc32_u8(rest, std::to_integer<std::uint8_t>(*at));
    return ~rest;
}
#endif

}  // namespace

std::uint32_t crc32cByTable(std::span<const std::byte> bytes) {
    std::uint32_t value = 0xffffffff;
    for (const auto byte : bytes)
        value = (value >> 8) ^ crcTable[(value ^ std::to_integer<std::uint32_t>(byte)) & 0xff];
    return ~value;
}

std::uint32_t crc32c(std::span<const std::byte> bytes) {
#if defined(__x86_64__)
    static const bool hasInstruction = __builtin_cpu_supports("sse4.2") != 0;
    if (hasInstruction) return crc32cByInstruction(bytes);
#endif
    return crc32cByTable(bytes);
}

}  // namespace scancast::import_e57
