// Randomness that is a pure function of integers: the same on every machine, thread and run.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace scancast {

/// A bijection of 64-bit words that leaves no visible pattern (the finaliser of splitmix64).
constexpr std::uint64_t mixBits(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

constexpr std::uint64_t mixBits(std::uint64_t a, std::uint64_t b) {
    return mixBits(a ^ mixBits(b));
}

/// 0 ≤ result < 1.
constexpr float unitFloat(std::uint64_t bits) {
    return float(bits >> 40) * 0x1p-24F;
}
constexpr double unitDouble(std::uint64_t bits) {
    return double(bits >> 11) * 0x1p-53;
}

/// A number in [0, 1) for a lattice point of the plane: brick 7 of row 3, flagstone (4, 9).
constexpr float hashUnit(int x, int y, std::uint32_t salt = 0) {
    return unitFloat(mixBits((std::uint64_t(std::uint32_t(x)) << 32) | std::uint32_t(y), salt));
}

/// A short stream of numbers that belongs to one point.
class PointRandom {
  public:
    PointRandom(std::uint64_t seed, std::uint64_t index) : state_(mixBits(seed, index)) {}

    std::uint64_t bits() { return mixBits(state_ += 0x9e3779b97f4a7c15ULL); }
    float unit() { return unitFloat(bits()); }
    float range(float low, float high) { return low + (high - low) * unit(); }
    /// Bell-shaped with mean 0 and standard deviation 1; never beyond ± bellLimit.
    double bell() {
        const std::uint64_t word = bits();
        double sum = 0;
        for (int part = 0; part < 4; ++part) sum += double((word >> (16 * part)) & 0xffff) * (1.0 / 65535);
        return (sum - 2) * 1.7320508075688772;
    }
    static constexpr double bellLimit = 3.4641016151377544;

  private:
    std::uint64_t state_;
};

/// Smooth noise in [0, 1] with one bump a unit.
inline float smoothNoise(glm::vec2 at, std::uint32_t salt) {
    const float floorX = std::floor(at.x), floorY = std::floor(at.y);
    const int x = int(floorX), y = int(floorY);
    const auto ease = [](float t) { return t * t * (3 - 2 * t); };
    const float tx = ease(at.x - floorX), ty = ease(at.y - floorY);
    const float low = hashUnit(x, y, salt) * (1 - tx) + hashUnit(x + 1, y, salt) * tx;
    const float high = hashUnit(x, y + 1, salt) * (1 - tx) + hashUnit(x + 1, y + 1, salt) * tx;
    return low * (1 - ty) + high * ty;
}

}  // namespace scancast
