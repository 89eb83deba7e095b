#include "renderer/cloud/sample.hpp"

#include <immintrin.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace scancast {

namespace {

// The octahedron |x| + |y| + |z| = 1 unfolded onto the square [-1,1]²; 127 steps each side of 128, so that
// the axes are exact and the value 0 stays free for noNormal.
constexpr float steps = 127.0f;

float signOf(float v) {
    return v < 0 ? -1.0f : 1.0f;
}

typedef float Four __attribute__((vector_size(4 * sizeof(float))));

/// What a byte of a code is on its axis of the square.
constexpr auto places = [] {
    std::array<float, 256> table{};
    for (int code = 0; code < 256; ++code) table[std::size_t(code)] = float(code - 128) / steps;
    return table;
}();

std::uint16_t pack(float u, float v) {
    return static_cast<std::uint16_t>((static_cast<int>(u) + 128) << 8 | (static_cast<int>(v) + 128));
}

}  // namespace

glm::vec3 decodeNormal(std::uint16_t code) {
    if (code == noNormal) return glm::vec3(0);
    const float u = places[code >> 8], v = places[code & 255];
    glm::vec3 n(u, v, 1 - std::abs(u) - std::abs(v));
    if (n.z < 0) {
        n.x = (1 - std::abs(v)) * signOf(u);
        n.y = (1 - std::abs(u)) * signOf(v);
    }
    // One division of four numbers costs what one of a single number does.
    const float length = std::sqrt(glm::dot(n, n));
    const Four unit = Four{n.x, n.y, n.z, 0} / length;
    return {unit[0], unit[1], unit[2]};
}

std::uint16_t encodeNormal(glm::vec3 n) {
    const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    if (!(sum > 0) || !std::isfinite(sum)) return noNormal;
    float u = n.x / sum, v = n.y / sum;
    if (n.z < 0) {
        const float folded = (1 - std::abs(v)) * signOf(n.x);
        v = (1 - std::abs(u)) * signOf(n.y);
        u = folded;
    }
    // Rounding each axis by itself is not the nearest direction: the best of the four neighbours is.
    const float u0 = std::min(std::floor(u * steps), steps - 1),
                v0 = std::min(std::floor(v * steps), steps - 1);
    // They are decoded side by side, as decodeNormal() does each.
    const std::uint16_t first = pack(u0, v0);
    constexpr std::array<std::uint16_t, 4> neighbours{0, 256, 1, 257};
    const std::size_t atU = first >> 8, atV = first & 255;
    const Four cu{places[atU], places[atU + 1], places[atU], places[atU + 1]};
    const Four cv{places[atV], places[atV], places[atV + 1], places[atV + 1]};
    const Four one{1, 1, 1, 1}, au = cu < 0 ? -cu : cu, av = cv < 0 ? -cv : cv, z = one - au - av;
    const Four foldedX = one - av, foldedY = one - au;
    const Four x = z < 0 ? (cu < 0 ? -foldedX : foldedX) : cu;
    const Four y = z < 0 ? (cv < 0 ? -foldedY : foldedY) : cv;
    const Four length(_mm_sqrt_ps(__m128(x * x + y * y + z * z)));
    const Four along = x / length * n.x + y / length * n.y + z / length * n.z;
    std::uint16_t best = first;
    float bestDot = -4;
    for (std::size_t i = 0; i < 4; ++i) {
        if (along[int(i)] > bestDot) {
            bestDot = along[int(i)];
            best = std::uint16_t(first + neighbours[i]);
        }
    }
    return best;
}

}  // namespace scancast
