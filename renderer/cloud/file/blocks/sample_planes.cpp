#include "renderer/cloud/file/blocks/sample_planes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace scancast {

namespace {

// One sample is one vector of the compiler's (128 bits on every machine), as bytes or as 16-bit numbers.
using Bytes16 = std::uint8_t __attribute__((vector_size(16)));
using Words8 = std::uint16_t __attribute__((vector_size(16)));
using SignedBytes16 = std::int8_t __attribute__((vector_size(16)));
using SignedWords8 = std::int16_t __attribute__((vector_size(16)));
constexpr std::size_t lanes = 16;
using Tile = std::array<Bytes16, lanes>;

constexpr Words8 positionWords{0xffff, 0xffff, 0xffff, 0, 0, 0, 0, 0};
constexpr Bytes16 colorBytes{0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 0, 0, 0, 0, 0};

/// Green in the places of red and blue, 0 elsewhere.
Bytes16 greenAround(Bytes16 v) {
    constexpr Bytes16 redAndBlue{0, 0, 0, 0, 0, 0, 0, 0, 255, 0, 255, 0, 0, 0, 0, 0};
    return __builtin_shufflevector(v, v, 0, 0, 0, 0, 0, 0, 0, 0, 9, 9, 9, 0, 0, 0, 0, 0) & redAndBlue;
}

/// 0, -1, 1, -2 … become 0, 1, 2, 3 …, in the words of positions and the bytes of colours.
Bytes16 foldSigns(Bytes16 v) {
    const Words8 w = Words8(v);
    const Words8 foldedWords = (w << 1) ^ Words8(SignedWords8(w) >> 15);
    const Bytes16 foldedBytes = (v + v) ^ Bytes16(SignedBytes16(v) < 0);
    return (Bytes16(foldedWords) & Bytes16(positionWords)) | (foldedBytes & colorBytes) |
           (v & ~(Bytes16(positionWords) | colorBytes));
}

Bytes16 unfoldSigns(Bytes16 v) {
    const Words8 w = Words8(v);
    const Words8 words = (w >> 1) ^ (0 - (w & 1));
    const Bytes16 bytes = (v >> 1) ^ (0 - (v & 1));
    return (Bytes16(words) & Bytes16(positionWords)) | (bytes & colorBytes) |
           (v & ~(Bytes16(positionWords) | colorBytes));
}

/// What of a sample counts from the one before: positions as words, colours as bytes.
Bytes16 difference(Bytes16 v, Bytes16 before) {
    const Words8 words = Words8(v) - (Words8(before) & positionWords);
    const Bytes16 bytes = v - (before & colorBytes);
    return (bytes & colorBytes) | (Bytes16(words) & ~colorBytes);
}

Bytes16 sum(Bytes16 v, Bytes16 before) {
    const Words8 words = Words8(v) + (Words8(before) & positionWords);
    const Bytes16 bytes = v + (before & colorBytes);
    return (bytes & colorBytes) | (Bytes16(words) & ~colorBytes);
}

/// Rows and columns of 16 × 16 bytes change places: four rounds, each of which interleaves row i with row
/// i + 8.
void transpose(Tile& tile) {
    for (int round = 0; round < 4; ++round) {
        Tile next;
        for (std::size_t i = 0; i < lanes / 2; ++i) {
            const Bytes16 a = tile[i], b = tile[i + lanes / 2];
            next[2 * i] =
                __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            next[2 * i + 1] =
                __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
        }
        tile = next;
    }
}

}  // namespace

void toPlanes(std::span<const Sample> samples, std::span<std::byte> planes) {
    const std::size_t n = samples.size();
    Bytes16 before{};
    for (std::size_t first = 0; first < n; first += lanes) {
        const std::size_t count = std::min(lanes, n - first);
        Tile tile{};
        std::memcpy(tile.data(), &samples[first], count * sizeof(Sample));
        for (std::size_t i = 0; i < count; ++i) {
            const Bytes16 v = tile[i] - greenAround(tile[i]);
            tile[i] = foldSigns(difference(v, before));
            before = v;
        }
        transpose(tile);
        for (std::size_t p = 0; p < lanes; ++p) std::memcpy(&planes[p * n + first], &tile[p], count);
    }
}

void fromPlanes(std::span<const std::byte> planes, std::span<Sample> samples) {
    const std::size_t n = samples.size();
    Bytes16 before{};
    for (std::size_t first = 0; first < n; first += lanes) {
        const std::size_t count = std::min(lanes, n - first);
        Tile tile{};
        for (std::size_t p = 0; p < lanes; ++p) std::memcpy(&tile[p], &planes[p * n + first], count);
        transpose(tile);
        for (std::size_t i = 0; i < count; ++i) {
            before = sum(unfoldSigns(tile[i]), before);
            tile[i] = before + greenAround(before);
        }
        std::memcpy(&samples[first], tile.data(), count * sizeof(Sample));
    }
}

}  // namespace scancast
