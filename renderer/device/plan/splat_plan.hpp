// From what a method asks for to what devices splat: the host-side arithmetic that `cpu` and `gl` share, so
// that it cannot drift apart. Pure functions. Pipeline: passes → **splat plan** → device.
#pragma once

#include "protocol/view/view.hpp"
#include "renderer/device/pass.hpp"
#include "renderer/device/plan/splat_kind.hpp"

namespace scancast {

/// Beyond these, floats of kernels and shaders could overflow; nothing real is that large.
inline constexpr double largestCoefficient = 1e24;
inline constexpr float farthestDepth = 1e30f;

/// Footprint::Pixel counts as a square; spheres are not defined outside their circle (docs/spec/sprites.md
/// §3).
SplatShape splatShape(Footprint footprint, Profile profile);
SplatColoring splatColoring(ColorSource source);

/// r | g << 8 | b << 16, as samples and payloads hold it.
inline std::uint32_t packed(const Rgb8& c) {
    return static_cast<std::uint32_t>(c[0]) | static_cast<std::uint32_t>(c[1]) << 8 |
           static_cast<std::uint32_t>(c[2]) << 16;
}

}  // namespace scancast
