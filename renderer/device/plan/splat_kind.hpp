// What both devices tell apart when they splat: the kinds that kernels and shaders are specialised for.
// Plain enumerations and nothing else, because SIMD kernels include this (no inline functions there; decision
// 2).
#pragma once

#include <cstdint>

namespace scancast {

/// What a splat looks like: footprint and profile together, as far as they are drawn differently.
enum class SplatShape : std::uint8_t {
    FlatSquare,
    FlatCircle,
    ParaboloidSquare,
    ParaboloidCircle,
    ConeSquare,
    ConeCircle,
    SphereCircle,
    Disc,  ///< surfels
    Ellipse,
};

/// Where a splat's colour comes from. PerRun: one colour for every sample of a run (lod, flat).
enum class SplatColoring : std::uint8_t { Rgb, PerRun, Intensity, Elevation, Classification, Normal, Depth };

}  // namespace scancast
