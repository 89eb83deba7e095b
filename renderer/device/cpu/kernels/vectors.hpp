// The vectors of one SIMD level: native widths only, by the compiler's own extension. Part of kernels.cpp.
#pragma once

#include <cstdint>

#include "renderer/device/cpu/kernels/kernels.hpp"

namespace scancast::cpu {
namespace {

template <int lanes>
struct Vectors {
    typedef float Float __attribute__((vector_size(4 * lanes)));
    typedef std::int32_t Int __attribute__((vector_size(4 * lanes)));
};

template <int lanes>
using Float = typename Vectors<lanes>::Float;
template <int lanes>
using Int = typename Vectors<lanes>::Int;

using Ints4 = Int<4>;
using Ints8 = Int<8>;

typedef Key Keys2 __attribute__((vector_size(16)));
typedef Key Keys4 __attribute__((vector_size(32)));
typedef Key Keys8 __attribute__((vector_size(64)));

/// From and to any address: an aligned(…) attribute would get lost on the way through templates and auto.
template <class Vector>
inline Vector load(const void* place) {
    Vector v;
    __builtin_memcpy(&v, place, sizeof v);
    return v;
}

template <class Vector>
inline void store(void* place, Vector v) {
    __builtin_memcpy(place, &v, sizeof v);
}

template <class Keys>
inline void keepNearest(Key* place, Keys candidate) {
    const Keys now = load<Keys>(place);
    store<Keys>(place, candidate < now ? candidate : now);
}

/// Keeps, lane by lane, the smaller of the keys at `place` and (order << 32 | payload).
inline void storeNearest(Key* place, Ints4 order, Ints4 payload) {
#if SCANCAST_SIMD_LEVEL >= 3
    keepNearest(place,
                reinterpret_cast<Keys4>(__builtin_shufflevector(payload, order, 0, 4, 1, 5, 2, 6, 3, 7)));
#else
    keepNearest(place, reinterpret_cast<Keys2>(__builtin_shufflevector(payload, order, 0, 4, 1, 5)));
    keepNearest(place + 2, reinterpret_cast<Keys2>(__builtin_shufflevector(payload, order, 2, 6, 3, 7)));
#endif
}

#if SCANCAST_SIMD_LEVEL >= 3
inline void storeNearest(Key* place, Ints8 order, Ints8 payload) {
#if SCANCAST_SIMD_LEVEL >= 4
    keepNearest(place, reinterpret_cast<Keys8>(__builtin_shufflevector(payload, order, 0, 8, 1, 9, 2, 10, 3,
                                                                       11, 4, 12, 5, 13, 6, 14, 7, 15)));
#else
    keepNearest(place,
                reinterpret_cast<Keys4>(__builtin_shufflevector(payload, order, 0, 8, 1, 9, 2, 10, 3, 11)));
    keepNearest(place + 4,
                reinterpret_cast<Keys4>(__builtin_shufflevector(payload, order, 4, 12, 5, 13, 6, 14, 7, 15)));
#endif
}
/// The widest row of float lanes that one register holds.
inline constexpr int wideLanes = 8;
#else
inline constexpr int wideLanes = 4;
#endif

/// 0, 1, 2 …
template <int lanes>
inline Float<lanes> laneNumbers() {
    if constexpr (lanes == 4) {
        return Float<4>{0, 1, 2, 3};
    } else {
        return Float<8>{0, 1, 2, 3, 4, 5, 6, 7};
    }
}

template <int lanes>
inline Float<lanes> squareRoot(Float<lanes> v) {
    Float<lanes> out;
    for (int i = 0; i < lanes; ++i) out[i] = __builtin_sqrtf(v[i]);
    return out;
}

}  // namespace
}  // namespace scancast::cpu
