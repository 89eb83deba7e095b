// The numbers of a splat pass and of a run of samples, worked out once on the host (stages.hpp, runs.hpp) and
// the same for every device, so that the same floats go into the same arithmetic. Plain structs of plain
// types and nothing else, because SIMD kernels include this (decision 2); shaders get them as layouts_splat.glsl
// packs them.
#pragma once

#include <cstdint>

#include "renderer/device/plan/splat_kind.hpp"

namespace scancast {

/// What a splat pass does with its fragments.
enum class Reduction : std::uint8_t {
    Nearest,  ///< keeps the smallest order; NearestPass, SilhouettePass
    Cell,     ///< the same by distance to the centre; CellPass
    Sum,      ///< adds; SumPass
};

/// Everything that holds for a whole splat pass.
struct SplatNumbers {
    Reduction reduction = Reduction::Nearest;
    SplatShape shape = SplatShape::FlatSquare;
    bool payloadSample = false;  ///< keys carry the sample's ordinal instead of distance and colour
    bool sumNormals = false;
    bool ownRadii = false;  ///< samples know their radii, and the pass's size follows them
    bool perspective = true;
    float centerX = 0, centerY = 0;  ///< the view axis, px in the whole picture, jitter included
    float near = 0, far = 0;         ///< depths drawn; near > 0
    float minPx = 1, maxPx = 1;
    float radiusPerPixel = 0;  ///< R = h · radiusPerPixel (· d in perspective)
    float gain = 0;

    /// Surfels (Disc, Ellipse).
    float pixelsPerUnit = 1;    ///< f in perspective, q in orthographic projection
    float scale = 1;            ///< drawn radius = r · scale
    float reach = 1;            ///< Sum of discs: covers reach · drawn radius
    float tolerance = 0;        ///< Cell, and Sum of discs: |d - d_vis| ≤ tolerance · drawn radius
    float lowPassPx = 0;        ///< Ellipse: σ of the screen's low-pass
    bool oriented = false;      ///< a normal's sign means something; else it is turned to the eye
    std::int32_t facing = 0;    ///< 1: only what faces the eye, -1: only what faces away, 0: all
    float rotation[3][3] = {};  ///< rows: cloud → view space (x right, y up, z towards the viewer)

    SplatColoring coloring = SplatColoring::Rgb;
    float colorLow = 0, colorScale = 0;  ///< index = clamp((value - low) · scale, 0, 255)
};

/// Where samples of a run are dropped: inside all planes, planes[i] · (x, y, z, 1) ≥ 0 of a sample's
/// integers.
struct DroppedRegion {
    float planes[5][4] = {};
    std::int32_t count = 0;
};

/// Everything that holds for one run of samples, whatever the pass.
struct RunNumbers {
    std::uint32_t color = 0;  ///< SplatColoring::PerRun
    /// Rows times (x, y, z, 1) of a sample's integers: horizontal and vertical place, px (· d in
    /// perspective), and depth.
    float toPicture[3][4] = {};
    float elevationStep = 0, elevationBase = 0;  ///< colour index of Elevation = z · step + base
    /// World radius r = plainRadius · ratio, with ratio = surfelRadii()[logRadius] · ratioUnit, or 1 where no
    /// radius is known.
    float ratioUnit = 1;
    float plainRadius = 1;           ///< cloud units
    std::uint32_t firstOrdinal = 0;  ///< of its first sample
    /// A sample is drawn if its ordinal · turnStep + turnBase, modulo 2^32, is not above lastTurn
    /// (renderer/select/fade.hpp); turnBase counts the ordinals from the run's beginning.
    std::uint32_t turnStep = 0, turnBase = 0, lastTurn = 0xffffffffu;
    bool clipped = false;
    std::int32_t clipMin[3] = {},
                 clipMax[3] = {};  ///< integers of the samples inside the clip box, inclusive
};

}  // namespace scancast
