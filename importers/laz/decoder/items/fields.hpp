// Places of fields in the items that hold a point, and the numbers that predict one field from others. ASPRS LAS 1.4 R15, tables 7
// and 14; "LAZ Specification 1.4". Pure functions and tables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "files/bytes.hpp"

namespace scancast::laz {

/// POINT10, and what POINT14 has at the same places.
enum PointAt : std::size_t {
    atX = 0,
    atY = 4,
    atZ = 8,
    atIntensity = 12,
    atReturns = 14,
    atUserData = 17,
    // POINT10
    atClass10 = 15,
    atAngle10 = 16,
    atSource10 = 18,
    // POINT14
    atFlags14 = 15,
    atClass14 = 16,
    atAngle14 = 18,
    atSource14 = 20,
    atTime14 = 22,
};

/// Adds modulo 2^32.
inline void addTo(std::byte* number, std::int32_t difference) {
    storeLe(number, loadLe<std::uint32_t>(number) + static_cast<std::uint32_t>(difference));
}

inline std::int32_t product(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(b));
}

/// Even numbers of up to `most`, as contexts.
inline std::size_t evenContext(std::uint32_t size, std::uint32_t most) {
    return size < most ? size & ~1U : most;
}

inline int clampToByte(int number) {
    return number < 0 ? 0 : number > 255 ? 255 : number;
}

/// The context of return r of n (0-7 each): those of up to 5 returns have one for each, and combinations that
/// cannot be share theirs.
inline constexpr std::uint8_t returnContext10[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},    {13, 1, 2, 4, 7, 11, 11, 10},
    {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},   {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
};

/// How far return r is from the last of n.
inline std::size_t returnLevel(std::uint32_t n, std::uint32_t r) {
    const std::uint32_t level = n > r ? n - r : r - n;
    return level < 7 ? level : 7;
}

/// The context of return r of n (0-15 each) in POINT14: a digit for each r.
inline constexpr const char* returnContext14[16] = {
    "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
    "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
    "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
    "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455",
};

}  // namespace scancast::laz
