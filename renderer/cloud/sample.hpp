// The final sample: 16 bytes that the devices draw, and the codecs of its fields.
// One layout for the CPU device, the GL device (one uvec4) and the cloud file. And the word beside it.
// Source: docs/spec/hierarchy.md §5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

namespace scancast {

/// Position: node.boxMin + node.step * (x, y, z), cloud-relative. Every field is little-endian.
struct Sample {
    std::uint16_t x, y, z;
    std::uint16_t intensity;      ///< the file's own 0–65535
    std::uint8_t r, g, b;         ///< sRGB
    std::uint8_t classification;  ///< ASPRS class
    std::uint16_t normal;         ///< octahedral 8 + 8; noNormal = none
    std::uint8_t logRadius;       ///< surfel radius (surfel_codec.hpp); 0 = none: use the node's spacing
    std::uint8_t ellipse;         ///< axis ratio (high 3 bits) and angle (low 5 bits); 0 = circle
};
static_assert(sizeof(Sample) == 16 && alignof(Sample) == 2);
static_assert(offsetof(Sample, intensity) == 6 && offsetof(Sample, r) == 8 && offsetof(Sample, normal) == 12);

inline constexpr std::uint16_t noNormal = 0;

/// What stands beside a sample in memory and on devices, where there is anything: how the surface bends there (the lower three
/// bytes, curvature.hpp) and its near infrared, 0-255 (the highest). 0 each where there is none. In a cloud file these are
/// planes of their own (file/CLOUD_FILE.md); the words come with the samples where somebody asks for them.
using BesideWord = std::uint32_t;

inline constexpr BesideWord besideCurvature = 0x00ffffff;

constexpr std::uint32_t curvatureIn(BesideWord word) {
    return word & besideCurvature;
}
constexpr std::uint8_t nearInfraredIn(BesideWord word) {
    return std::uint8_t(word >> 24);
}
constexpr BesideWord withCurvature(BesideWord word, std::uint32_t code) {
    return (word & ~besideCurvature) | curvatureIn(code);
}
constexpr BesideWord withNearInfrared(BesideWord word, std::uint8_t value) {
    return curvatureIn(word) | BesideWord(value) << 24;
}

/// Octahedral encoding, 8 bits an axis, of a unit vector (error ≤ 0.95°). Never yields noNormal.
std::uint16_t encodeNormal(glm::vec3 n);
/// Unit vector; (0,0,0) for noNormal.
glm::vec3 decodeNormal(std::uint16_t code);

}  // namespace scancast
