// Little-endian loads and stores at any address: what the LAS reader and the point stream are made of.
// Pure functions. The caller has checked that the bytes are there.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace scancast {

// Every machine that Scancast runs on is little-endian; the formats are too, so a load is a copy.
static_assert(std::endian::native == std::endian::little);

template <class T>
T loadLe(const std::byte* from) {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

template <class T>
void storeLe(std::byte* to, T value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::memcpy(to, &value, sizeof value);
}

}  // namespace scancast
