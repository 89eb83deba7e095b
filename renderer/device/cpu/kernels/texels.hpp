// What the kernels of pyramids share: rows of pixels side by side with rows of coarser texels. Part of
// kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/pyramid.hpp"
#include "renderer/device/cpu/kernels/vectors.hpp"

namespace scancast::cpu {
namespace {

inline constexpr float infinity = __builtin_inff();
/// Depths above it are infinite: nothing is there.
inline constexpr float finiteDepths = 3.4e38f;

inline IntW laneIndices() {
    return toInt(laneNumbers<wideLanes>());
}

inline std::int64_t rowOf(std::int32_t stride, int y) {
    return static_cast<std::int64_t>(stride) * y;
}

/// A row of a level's texels seen from a row of pixels. Where pixels begin at a multiple of wideLanes, texels
/// of level 1 change after pixel 0, 2, 4 …, those of level 2 after pixel 1, 5 …, those of level 3 after 3, 11
/// …, if what counts is the middle between two texels; so the lanes' texels are a fixed pattern.
/// `first` is lane 0's texel. Levels of which a vector sees one texel only are all like `wideLevel`.
#if SCANCAST_SIMD_LEVEL >= 3
inline constexpr int wideLevel = 4;
#else
inline constexpr int wideLevel = 3;
#endif

template <int level>
inline FloatW spread(const float* first) {
    if constexpr (level == 0) return load<FloatW>(first);
    if constexpr (level >= wideLevel) return all(*first);
    const FloatW v = load<FloatW>(first);
#if SCANCAST_SIMD_LEVEL >= 3
    if constexpr (level == 1) return __builtin_shufflevector(v, v, 0, 1, 1, 2, 2, 3, 3, 4);
    if constexpr (level == 2) return __builtin_shufflevector(v, v, 0, 0, 1, 1, 1, 1, 2, 2);
    return __builtin_shufflevector(v, v, 0, 0, 0, 0, 1, 1, 1, 1);
#else
    if constexpr (level == 1) return __builtin_shufflevector(v, v, 0, 1, 1, 2);
    return __builtin_shufflevector(v, v, 0, 0, 1, 1);
#endif
}

/// Of a level ≥ 1: the last texel whose centre is not right of the pixel's (below it, for rows).
inline int texelBefore(int pixel, int level) {
    return ((pixel >> (level - 1)) - 1) >> 1;
}

/// Calls work.template run<level>(), with levels above wideLevel as wideLevel. level ≥ 1.
template <class Work>
inline void withSpread(int level, const Work& work) {
    switch (level) {
        case 1:
            return work.template run<1>();
        case 2:
            return work.template run<2>();
        case 3:
            return work.template run<3>();
        default:
            return work.template run<4>();
    }
}

/// Every second value of two vectors in a row.
template <class Vector>
inline Vector evens(Vector a, Vector b) {
#if SCANCAST_SIMD_LEVEL >= 3
    return __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
#else
    return __builtin_shufflevector(a, b, 0, 2, 4, 6);
#endif
}

template <class Vector>
inline Vector odds(Vector a, Vector b) {
#if SCANCAST_SIMD_LEVEL >= 3
    return __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
#else
    return __builtin_shufflevector(a, b, 1, 3, 5, 7);
#endif
}

/// The pixels of a 2 × 2 block, for a row of blocks.
template <class Vector>
struct Four {
    Vector v[4];  ///< top left, top right, bottom left, bottom right
};

template <class Vector>
inline Four<Vector> loadFours(const void* top, const void* bottom) {
    constexpr int bytes = 4 * wideLanes;
    const auto at = [](const void* p, int offset) {
        return load<Vector>(static_cast<const unsigned char*>(p) + offset);
    };
    const Vector a = at(top, 0), b = at(top, bytes), c = at(bottom, 0), d = at(bottom, bytes);
    return {{evens(a, b), odds(a, b), evens(c, d), odds(c, d)}};
}

/// Writes the lanes that lie inside a row.
template <class Vector>
inline void storeInside(float* row, int x, int width, Vector v) {
    if (x + wideLanes <= width) {
        store(row + x, v);
    } else {
        storeSome(row + x, v, width - x);
    }
}

/// Labels of pixels, one byte each, as lanes.
inline IntW loadLabels(const std::uint8_t* place) {
    typedef std::uint8_t Bytes __attribute__((vector_size(wideLanes)));
    return __builtin_convertvector(load<Bytes>(place), IntW);
}

inline void storeLabels(std::uint8_t* place, IntW labels) {
    typedef std::uint8_t Bytes __attribute__((vector_size(wideLanes)));
    store(place, __builtin_convertvector(labels, Bytes));
}

}  // namespace
}  // namespace scancast::cpu
