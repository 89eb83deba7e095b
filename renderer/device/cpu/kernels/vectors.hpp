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

/// The smaller of two keys, lane by lane. As doubles (emptyOrder), of which old processors can compare two at once.
inline Keys2 nearer(Keys2 a, Keys2 b) {
    typedef double Doubles __attribute__((vector_size(16)));
    return reinterpret_cast<Keys2>(
        __builtin_ia32_minpd(reinterpret_cast<Doubles>(a), reinterpret_cast<Doubles>(b)));
}
#if SCANCAST_SIMD_LEVEL >= 3
inline Keys4 nearer(Keys4 a, Keys4 b) {
    typedef double Doubles __attribute__((vector_size(32)));
    return reinterpret_cast<Keys4>(
        __builtin_ia32_minpd256(reinterpret_cast<Doubles>(a), reinterpret_cast<Doubles>(b)));
}
#endif
#if SCANCAST_SIMD_LEVEL >= 4
inline Keys8 nearer(Keys8 a, Keys8 b) {
    return a < b ? a : b;
}
#endif

template <class Keys>
inline void keepNearest(Key* place, Keys candidate) {
    store<Keys>(place, nearer(candidate, load<Keys>(place)));
}

/// Keeps, lane by lane, the smaller of the keys at `place` and (order << 32 | payload); the second half of the lanes has its keys
/// at `second`, if it says so.
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
inline void storeNearest(Key* place, Key* second, Ints8 order, Ints8 payload) {
    keepNearest(place,
                reinterpret_cast<Keys4>(__builtin_shufflevector(payload, order, 0, 8, 1, 9, 2, 10, 3, 11)));
    keepNearest(second,
                reinterpret_cast<Keys4>(__builtin_shufflevector(payload, order, 4, 12, 5, 13, 6, 14, 7, 15)));
}

inline void storeNearest(Key* place, Ints8 order, Ints8 payload) {
#if SCANCAST_SIMD_LEVEL >= 4
    keepNearest(place, reinterpret_cast<Keys8>(__builtin_shufflevector(payload, order, 0, 8, 1, 9, 2, 10, 3,
                                                                       11, 4, 12, 5, 13, 6, 14, 7, 15)));
#else
    storeNearest(place, place + 4, order, payload);
#endif
}
/// The widest row of float lanes that one register holds.
inline constexpr int wideLanes = 8;
#else
inline constexpr int wideLanes = 4;
#endif

/// Lanes are 0 or -1.
template <int lanes>
inline bool anyOf(Int<lanes> mask) {
#if SCANCAST_SIMD_LEVEL >= 3
    if constexpr (lanes == 8) return __builtin_ia32_movmskps256(reinterpret_cast<Float<8>>(mask)) != 0;
#endif
    if constexpr (lanes == 4) return __builtin_ia32_movmskps(reinterpret_cast<Float<4>>(mask)) != 0;
}

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

using FloatW = Float<wideLanes>;
using IntW = Int<wideLanes>;

inline FloatW all(float v) {
    return FloatW{} + v;
}
inline IntW all(std::int32_t v) {
    return IntW{} + v;
}
inline FloatW toFloat(IntW v) {
    return __builtin_convertvector(v, FloatW);
}
/// Towards zero; for |v| < 2^31.
inline IntW toInt(FloatW v) {
    return __builtin_convertvector(v, IntW);
}
/// The second one where either is not a number, as a < b ? a : b has it; the compiler would take two instructions.
inline FloatW smaller(FloatW a, FloatW b) {
#if SCANCAST_SIMD_LEVEL >= 3
    return __builtin_ia32_minps256(a, b);
#else
    return __builtin_ia32_minps(a, b);
#endif
}
inline FloatW larger(FloatW a, FloatW b) {
#if SCANCAST_SIMD_LEVEL >= 3
    return __builtin_ia32_maxps256(a, b);
#else
    return __builtin_ia32_maxps(a, b);
#endif
}
inline FloatW floorOf(FloatW v) {
    constexpr int downwards = 1, quietly = 8;
#if SCANCAST_SIMD_LEVEL >= 3
    return __builtin_ia32_roundps256(v, downwards | quietly);
#else
    return __builtin_ia32_roundps(v, downwards | quietly);
#endif
}

/// Bit i is lane i of a mask.
inline int bitsOf(IntW mask) {
#if SCANCAST_SIMD_LEVEL >= 3
    return __builtin_ia32_movmskps256(reinterpret_cast<FloatW>(mask));
#else
    return __builtin_ia32_movmskps(reinterpret_cast<FloatW>(mask));
#endif
}

/// order << 32 | payload, lane by lane, to an array.
inline void storeKeys(Key* place, IntW order, IntW payload) {
#if SCANCAST_SIMD_LEVEL >= 3
    store(place, __builtin_shufflevector(payload, order, 0, 8, 1, 9, 2, 10, 3, 11));
    store(place + 4, __builtin_shufflevector(payload, order, 4, 12, 5, 13, 6, 14, 7, 15));
#else
    store(place, __builtin_shufflevector(payload, order, 0, 4, 1, 5));
    store(place + 2, __builtin_shufflevector(payload, order, 2, 6, 3, 7));
#endif
}

inline void loadKeys(const Key* place, const Key* next, IntW& order, IntW& payload) {
    const IntW first = load<IntW>(place), second = load<IntW>(next);
#if SCANCAST_SIMD_LEVEL >= 3
    payload = __builtin_shufflevector(first, second, 0, 2, 4, 6, 8, 10, 12, 14);
    order = __builtin_shufflevector(first, second, 1, 3, 5, 7, 9, 11, 13, 15);
#else
    payload = __builtin_shufflevector(first, second, 0, 2, 4, 6);
    order = __builtin_shufflevector(first, second, 1, 3, 5, 7);
#endif
}

inline void loadKeys(const Key* place, IntW& order, IntW& payload) {
    loadKeys(place, place + wideLanes / 2, order, payload);
}

/// The first `count` lanes only; the others are 0.
template <class Vector>
inline Vector loadSome(const void* place, int count) {
    Vector v{};
    __builtin_memcpy(&v, place, static_cast<unsigned>(count) * 4);
    return v;
}

template <class Vector>
inline void storeSome(void* place, Vector v, int count) {
    __builtin_memcpy(place, &v, static_cast<unsigned>(count) * 4);
}

}  // namespace
}  // namespace scancast::cpu
