// The final sample: 16 bytes that the devices draw, and the codecs of its fields.
// One layout for the CPU device, the GL device (one uvec4) and the cloud file.
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

/// Octahedral encoding, 8 bits an axis, of a unit vector (error ≤ 0.95°). Never yields noNormal.
std::uint16_t encodeNormal(glm::vec3 n);
/// Unit vector; (0,0,0) for noNormal.
glm::vec3 decodeNormal(std::uint16_t code);

}  // namespace scancast
