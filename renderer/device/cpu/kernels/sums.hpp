// Adding fragments to a tile's planes of sums, and depths to test them by. Shared by every footprint that has
// a `sum` pass. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/vectors.hpp"

namespace scancast::cpu {
namespace {

/// Lanes are pixels of one row, or of two: the second half of them may lie elsewhere, `second` keys after the first.
template <int lanes>
inline constexpr std::int64_t sameRow = lanes / 2;

/// Depths of `lanes` keys; not a number where there is none, so that no comparison holds.
template <int lanes>
inline Float<lanes> loadOrders(const Key* place, std::int64_t second = sameRow<lanes>) {
    if constexpr (lanes == wideLanes) {
        IntW order, payload;
        loadKeys(place, place + second, order, payload);
        return reinterpret_cast<Float<lanes>>(order);
    } else {
        const Ints4 low = load<Ints4>(place), high = load<Ints4>(place + 2);
        return reinterpret_cast<Float<4>>(__builtin_shufflevector(low, high, 1, 3, 5, 7));
    }
}

/// Their payloads.
template <int lanes>
inline Int<lanes> loadPayloads(const Key* place, std::int64_t second = sameRow<lanes>) {
    if constexpr (lanes == wideLanes) {
        IntW order, payload;
        loadKeys(place, place + second, order, payload);
        return payload;
    } else {
        return __builtin_shufflevector(load<Ints4>(place), load<Ints4>(place + 2), 0, 2, 4, 6);
    }
}

/// What a splat adds per unit of weight, in every lane.
template <int lanes>
struct Addends {
    Int<lanes> red, green, blue, x, y, z;

    explicit Addends(std::uint32_t color) {
        const Int<lanes> zero{};
        red = zero + static_cast<std::int32_t>(color & 255);
        green = zero + static_cast<std::int32_t>((color >> 8) & 255);
        blue = zero + static_cast<std::int32_t>((color >> 16) & 255);
        x = y = z = zero;
    }
    /// A unit vector in view space.
    void setNormal(float nx, float ny, float nz) {
        const Int<lanes> zero{};
        const auto rounded = [](float v) {
            return static_cast<std::int32_t>(v * normalSteps + (v < 0 ? -0.5f : 0.5f));
        };
        x = zero + rounded(nx);
        y = zero + rounded(ny);
        z = zero + rounded(nz);
    }
};

/// Normals of the lanes, each part of them at most 1; they need not be one unit long.
template <int lanes>
inline Int<lanes> quantiseNormal(Float<lanes> v) {
    const Float<lanes> above = v > -1.0f ? v : Float<lanes>{} - 1.0f;
    const Float<lanes> within = above < 1.0f ? above : Float<lanes>{} + 1.0f;
    const Float<lanes> half = within < 0.0f ? Float<lanes>{} - 0.5f : Float<lanes>{} + 0.5f;
    return __builtin_convertvector(within * normalSteps + half, Int<lanes>);
}

/// 12 bits; at least 1 where covered, 0 elsewhere. `weight` in [0, 1] where covered.
template <int lanes>
inline Int<lanes> quantiseWeight(Float<lanes> weight, Int<lanes> covered) {
    const Float<lanes> scaled =
        (covered ? weight : Float<lanes>{}) * static_cast<float>(largestWeight) + 0.5f;
    const Int<lanes> whole = __builtin_convertvector(scaled, Int<lanes>);
    return (whole > 1 ? whole : Int<lanes>{} + 1) & covered;
}

/// Products of numbers of 16 bits, the first not negative: one instruction where a product of 32 bits takes
/// two or ten.
inline Ints4 smallProduct(Ints4 a, Ints4 b) {
    typedef short Shorts __attribute__((vector_size(16)));
    // Pairs are multiplied and added; the upper half of `a` is 0.
    return reinterpret_cast<Ints4>(
        __builtin_ia32_pmaddwd128(reinterpret_cast<Shorts>(a), reinterpret_cast<Shorts>(b)));
}
#if SCANCAST_SIMD_LEVEL >= 3
inline Ints8 smallProduct(Ints8 a, Ints8 b) {
    typedef short Shorts __attribute__((vector_size(32)));
    return reinterpret_cast<Ints8>(
        __builtin_ia32_pmaddwd256(reinterpret_cast<Shorts>(a), reinterpret_cast<Shorts>(b)));
}
#endif

/// `lanes` sums; their second half so many after the first.
template <int lanes>
inline Int<lanes> loadSums(const std::int32_t* place, [[maybe_unused]] std::int64_t second) {
#if SCANCAST_SIMD_LEVEL >= 3
    if constexpr (lanes == 8) {
        if (second != sameRow<lanes>)
            return __builtin_shufflevector(load<Ints4>(place), load<Ints4>(place + second), 0, 1, 2, 3, 4, 5,
                                           6, 7);
    }
#endif
    return load<Int<lanes>>(place);
}

template <int lanes>
inline void storeSums(std::int32_t* place, Int<lanes> sums, [[maybe_unused]] std::int64_t second) {
#if SCANCAST_SIMD_LEVEL >= 3
    if constexpr (lanes == 8) {
        if (second != sameRow<lanes>) {
            store(place, __builtin_shufflevector(sums, sums, 0, 1, 2, 3));
            store(place + second, __builtin_shufflevector(sums, sums, 4, 5, 6, 7));
            return;
        }
    }
#endif
    store(place, sums);
}

/// Adds `weight` times the addends at an offset (from pixel 0, 0) of the tile, normals the other way round where `turned`;
/// `full` collects where sums are nearly full. `second`: as above. Inlined by decree, as are the fragments that call it:
/// a call would move its seven vectors to memory and back.
template <int lanes, bool normals, bool turns>
[[gnu::always_inline]] inline void addFragments(const KeyTile& tile, std::int64_t offset, Int<lanes> weight,
                                                const Addends<lanes>& addends, Int<lanes> turned,
                                                Int<lanes>& full, std::int64_t second = sameRow<lanes>) {
    // Read before anything is written: it might be the tile itself, as far as the compiler knows.
    std::int32_t* place = tile.sums + offset;
    const std::int64_t step = tile.planeSize;
    const auto add = [&](Int<lanes> value) __attribute__((always_inline)) {
        const Int<lanes> sum = loadSums<lanes>(place, second) + value;
        storeSums<lanes>(place, sum, second);
        place += step;
        return sum;
    };
    full |= add(weight) >= fullSum;
    add(smallProduct(weight, addends.red));
    add(smallProduct(weight, addends.green));
    add(smallProduct(weight, addends.blue));
    if constexpr (normals) {
        const auto turn = [&](Int<lanes> value) __attribute__((always_inline)) {
            return turns ? (value ^ turned) - turned : value;
        };
        add(turn(smallProduct(weight, addends.x)));
        add(turn(smallProduct(weight, addends.y)));
        add(turn(smallProduct(weight, addends.z)));
    }
}

}  // namespace
}  // namespace scancast::cpu
