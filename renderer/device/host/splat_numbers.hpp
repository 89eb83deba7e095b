// The numbers of a splat pass and of a run of samples, worked out once on the host (splats.hpp) and the same for
// every device, so that the same floats go into the same arithmetic. Plain structs of plain types and constants
// of internal linkage, nothing else, because SIMD kernels include this (decision 2); shaders get them as
// layouts_splat.glsl packs them.
#pragma once

#include <cstdint>

#include "renderer/device/host/constants.hpp"

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

/// Where a splat's colour comes from. PerRun: one colour for every sample of a run (lod, flat). Toned: rgb, each
/// channel looked up on the ramp.
enum class SplatColoring : std::uint8_t {
    Rgb,
    PerRun,
    Intensity,
    Elevation,
    Classification,
    Normal,
    Depth,
    Toned,
    Curvature,
    Infrared,  ///< near infrared, red and green, each looked up on the ramp
};

/// What a splat pass does with its fragments.
enum class Reduction : std::uint8_t {
    Nearest,  ///< keeps the smallest order; NearestPass, SilhouettePass
    Cell,     ///< the same by distance to the centre; CellPass
    Sum,      ///< adds; SumPass
};

/// The 32 bits under a key's order.
enum class SplatPayload : std::uint8_t {
    Color,    ///< 8 bits of distance above the colour
    Sample,   ///< the sample's ordinal
    Surface,  ///< what later passes have to know of what is visible (docs/spec/passes.md §2.2)
};

/// Everything that holds for a whole splat pass.
struct SplatPass {
    Reduction reduction = Reduction::Nearest;
    bool silhouette = false;  ///< Nearest of what faces away: later passes drop what lies behind it
    SplatShape shape = SplatShape::FlatSquare;
    SplatPayload payload = SplatPayload::Color;  ///< of its keys
    bool sumNormals = false;
    bool curved = false;    ///< what it sums, or what is looked up by its payloads, has normals that turn
    bool ownRadii = false;  ///< samples know their radii, and the pass's size follows them
    bool perspective = true;
    float centerX = 0, centerY = 0;  ///< the view axis, px in the whole picture, jitter included
    float near = 0, far = 0;         ///< depths drawn; near > 0
    float minPx = 1, maxPx = 1;
    float radiusPerPixel = 0;  ///< R = h · radiusPerPixel (· d in perspective)
    float gain = 0;

    /// Surfels (Disc, Ellipse).
    float pixelsPerUnit = 1;  ///< f in perspective, q in orthographic projection
    float scale = 1;          ///< drawn radius = r · scale
    float reach = 1;          ///< Sum of discs: covers reach · drawn radius
    float tolerance =
        0;  ///< Cell, and Sum of discs: |d - d_vis| across the surface ≤ tolerance · drawn radius
    float lowPassPx = 0;        ///< Ellipse: σ of the screen's low-pass
    float ratioStep = 0;        ///< Ellipse: by how much b/a falls with each step of its code; 0: circles
    bool outliers = false;      ///< outliers are drawn, too
    std::int32_t facing = 0;    ///< 1: only what faces the eye, -1: only what faces away, 0: all
    float rotation[3][3] = {};  ///< rows: cloud → view space (x right, y up, z towards the viewer)

    SplatColoring coloring = SplatColoring::Rgb;
    float colorLow = 0, colorScale = 0;  ///< index = clamp((value - low) · scale, 0, 255)
    bool byIntensity = false;            ///< the colour times a factor, whose index is made the same way
    float intensityLow = 0, intensityScale = 0;

    /// What kernels look samples' bytes up in; a GPU has it in tables of its own.
    const float* radii =
        nullptr;  ///< 256 radii by logRadius; 0 for codes that know none. Null: no sample knows
    const std::uint32_t* ramp = nullptr;     ///< 256 colours, r | g << 8 | b << 16
    const std::uint32_t* factors = nullptr;  ///< 256, in 256ths, by intensity
    const std::uint32_t* normals = nullptr;  ///< 65,536 colours
    const float* curvatures = nullptr;       ///< 256, by byte (renderer/cloud/curvature.hpp)
    const std::uint8_t* classes = nullptr;   ///< 256 flags, 1 = drawn; null = all
};
/// Of a list: silhouette, nearest, cell, sum.
inline constexpr int mostSplatPasses = 4;

/// A piece of space, where samples of a run are dropped, or where alone they are kept: inside all planes, planes[i] ·
/// (x, y, z, 1) ≥ 0 of a sample's integers.
struct RunRegion {
    float planes[6][4] = {};
    std::int32_t count = 0;
};

/// Everything that holds for one run of samples, whatever the pass.
struct RunNumbers {
    std::uint32_t color = 0;  ///< SplatColoring::PerRun
    /// Rows times (x, y, z, 1) of a sample's integers: horizontal and vertical place, px (· d in
    /// perspective), and depth.
    float toPicture[3][4] = {};
    /// Colour index = value · step + base: of Elevation a sample's z, of Curvature k1 + k2 in 1 / radiusUnit.
    float indexStep = 0, indexBase = 0;
    /// World radius r = plainRadius · ratio, with ratio = surfelRadii()[logRadius] · ratioUnit, or 1 where no
    /// radius is known.
    float ratioUnit = 1;
    float plainRadius = 1;           ///< cloud units
    std::uint32_t firstOrdinal = 0;  ///< of its first sample
    /// A sample is drawn if its ordinal · turnStep + turnBase, modulo 2^32, is not above lastTurn
    /// (renderer/select/fade.hpp); turnBase counts the ordinals from the run's beginning.
    std::uint32_t turnStep = 0, turnBase = 0, lastTurn = 0xffffffffu;
    bool oriented =
        false;  ///< a normal's sign means something, but a two-sided circle's; else it is turned to the eye
    bool hasBeside = false;  ///< something stands beside its samples
    bool clipped = false;
    std::int32_t clipMin[3] = {},
                 clipMax[3] = {};  ///< integers of the samples inside the clip box, inclusive
};

/// Largest radius over depth in perspective: what reaches the eye's plane has no outline. Once for what is
/// drawn, once for what a sum extends it to.
constexpr float largestSpread = 0.5f, largestReach = 0.9f;
constexpr float rootOf6 = 2.4494897f;

/// Directions of the major axis that an ellipse byte may name (renderer/cloud/surfel_codec.hpp): 32, half a
/// turn in all.
constexpr int axisAngles = 32;
struct AxisDirections {
    float cosine[axisAngles], sine[axisAngles];
};
constexpr AxisDirections axisDirections = [] {
    AxisDirections table{};
    double c = 1, s = 0;
    for (int i = 0; i < axisAngles; ++i) {
        table.cosine[i] = static_cast<float>(c);
        table.sine[i] = static_cast<float>(s);
        const double next = c * 0.9951847266721969 - s * 0.0980171403295606;
        s = s * 0.9951847266721969 + c * 0.0980171403295606;
        c = next;
    }
    return table;
}();

}  // namespace scancast
