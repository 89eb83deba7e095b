#include "renderer/cloud/sample.hpp"

#include <glm/geometric.hpp>

#include <cmath>

namespace scancast {

namespace {

// The octahedron |x| + |y| + |z| = 1 unfolded onto the square [-1,1]²; 127 steps each side of 128, so that
// the axes are exact and the value 0 stays free for noNormal.
constexpr float steps = 127.0f;

float signOf(float v) {
    return v < 0 ? -1.0f : 1.0f;
}

std::uint16_t pack(float u, float v) {
    return static_cast<std::uint16_t>((static_cast<int>(u) + 128) << 8 | (static_cast<int>(v) + 128));
}

}  // namespace

glm::vec3 decodeNormal(std::uint16_t code) {
    if (code == noNormal) return glm::vec3(0);
    const float u = static_cast<float>((code >> 8) - 128) / steps;
    const float v = static_cast<float>((code & 255) - 128) / steps;
    glm::vec3 n(u, v, 1 - std::abs(u) - std::abs(v));
    if (n.z < 0) {
        n.x = (1 - std::abs(v)) * signOf(u);
        n.y = (1 - std::abs(u)) * signOf(v);
    }
    return n / std::sqrt(glm::dot(n, n));
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
    std::uint16_t best = pack(u0, v0);
    float bestDot = -4;
    for (int i = 0; i < 4; ++i) {
        const std::uint16_t code = pack(u0 + static_cast<float>(i & 1), v0 + static_cast<float>(i >> 1));
        const float d = glm::dot(decodeNormal(code), n);
        if (d > bestDot) {
            bestDot = d;
            best = code;
        }
    }
    return best;
}

}  // namespace scancast
