// Little-endian bytes of numbers, whatever the machine.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <vector>

namespace scancast {

static_assert(std::endian::native == std::endian::little, "the writers copy numbers as they are in memory");

/// Writes a number at `at` and returns the place behind it.
template <class Number>
std::byte* put(std::byte* at, Number value) {
    std::memcpy(at, &value, sizeof value);
    return at + sizeof value;
}

}  // namespace scancast
