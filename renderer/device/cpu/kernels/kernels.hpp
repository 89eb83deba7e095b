// The border between the device's host code and its kernels: plain structs and one table of functions per
// SIMD level.
//
// kernels.cpp is compiled once per level (x86-64-v2, v3, v4) and one table is chosen at run time. So that the
// linker can never replace a function of the program by a copy that was compiled for a newer processor,
// nothing that the kernels include may hold an inline function with external linkage: no standard library
// beyond <cstdint>, no GLM. tests/unit/cpu/check_kernel_symbols.cmake proves it on the object files.
//
// All kernels compute the same bytes: the operations are IEEE's (+, -, ·, /, sqrt), in one fixed order.
#pragma once

#include <cstdint>

#include "renderer/device/splat_kind.hpp"

namespace scancast::cpu {

/// Samples are read as four 32-bit words: x | y << 16, z | intensity << 16, rgb | class << 24, normal | ….
using SampleWords = std::uint32_t[4];

/// order << 32 | payload (pass.hpp). Orders are positive floats, so signed comparison sorts keys.
using Key = std::int64_t;
inline constexpr Key emptyKey = 0x7fffffffffffffff;
/// Bits of +infinity; an order at or above it means "no splat here".
inline constexpr std::int32_t infiniteOrder = 0x7f800000;

using Shape = SplatShape;
using Coloring = SplatColoring;

/// Everything that holds for a whole `nearest` pass.
struct SplatPass {
    Shape shape = Shape::FlatSquare;
    bool perspective = true;
    float centerX = 0, centerY = 0;  ///< the view axis, px in the whole picture, jitter included
    float near = 0, far = 0;         ///< depths drawn; near > 0
    float minPx = 1, maxPx = 1;
    float radiusPerPixel = 0;  ///< R = h · radiusPerPixel (· d in perspective)
    float gain = 0;
    Coloring coloring = Coloring::Rgb;
    float colorLow = 0, colorScale = 0;      ///< index = clamp((value - low) · scale, 0, 255)
    const std::uint32_t* ramp = nullptr;     ///< 256 colours, r | g << 8 | b << 16
    const std::uint32_t* normals = nullptr;  ///< 65,536 colours
    const std::uint8_t* classes = nullptr;   ///< 256 flags, 1 = drawn; null = all
};

/// One run of samples, made ready on the host in double.
struct SplatRun {
    const SampleWords* samples = nullptr;
    std::uint32_t count = 0;
    std::uint32_t color = 0;  ///< Coloring::PerRun
    /// Rows times (x, y, z, 1) of a sample's integers: horizontal and vertical place, px (· d in
    /// perspective), and depth.
    float toPicture[3][4] = {};
    float elevationStep = 0, elevationBase = 0;  ///< colour index of Coloring::Elevation = z · step + base
    float sizeFactor = 0;                        ///< p = clamp(sizeFactor (/ d in perspective), minPx, maxPx)
    float largestPx = 0;                         ///< no splat of the run is larger
    bool crossesTile = true;                     ///< some of it lies in other tiles
    bool clipped = false;
    std::int32_t clipMin[3] = {},
                 clipMax[3] = {};  ///< integers of the samples inside the clip box, inclusive
};

/// A tile of the picture being drawn by one thread. `keys` points at its pixel (0, 0) inside a larger block:
/// splats of up to guardPx pixels may write `guard` pixels beyond every side without asking.
struct KeyTile {
    Key* keys = nullptr;
    Key* unused = nullptr;      ///< unusedKeys words of nobody, for what falls outside
    std::int32_t stride = 0;    ///< keys per row
    std::int32_t x = 0, y = 0;  ///< its place in the whole picture
    std::int32_t width = 0, height = 0;
};
inline constexpr int guard = 16;
inline constexpr int unusedKeys = 64;
/// Larger splats are clipped row by row.
inline constexpr float guardPx = 8;

/// Where resolved pixels go: place of its first pixel, and background per row of the tile.
struct PixelTile {
    std::uint32_t* rgba = nullptr;
    float* depth = nullptr;                     ///< null: not wanted
    std::int32_t stride = 0;                    ///< pixels per row
    const std::uint32_t* background = nullptr;  ///< one rgba per row
};

/// Eye-dome lighting of some rows. Every pixel has its eight neighbours in `logDepth`.
struct EyeDome {
    const float* logDepth =
        nullptr;  ///< log2 of the depth of the first row's first pixel; +infinity = background
    std::int32_t logStride = 0;
    const std::uint32_t* rgba = nullptr;
    std::int32_t stride = 0;
    std::uint32_t* out = nullptr;
    std::int32_t outStride = 0;
    std::int32_t width = 0, height = 0;
    std::int32_t offsets[8] = {};  ///< of the neighbours, in `logDepth`
    float factor = 0;              ///< shade = 2^(-factor · sum of the eight responses)
};

/// The kernels of one SIMD level.
struct Kernels {
    void (*clear)(const KeyTile&);
    void (*splat)(const SplatPass&, const SplatRun&, const KeyTile&);
    /// Whether every pixel of [x0, x1) × [y0, y1) (tile-relative) already lies in front of an order of these
    /// bits.
    bool (*hidden)(const KeyTile&, int x0, int y0, int x1, int y1, std::int32_t orderBits);
    void (*resolve)(const KeyTile&, const PixelTile&);
    void (*logDepth)(const float* depth, float* out, int count);
    void (*eyeDome)(const EyeDome&);
    /// sums[i] += rgba's bytes.
    void (*accumulate)(const std::uint8_t* rgba, std::uint16_t* sums, int bytes);
    /// The mean of `frames` pictures whose sums these are: colour weighted by coverage, straight alpha.
    void (*average)(const std::uint16_t* sums, std::uint8_t* rgba, int pixels, int frames);
};

namespace v2 {
extern const Kernels kernels;
}
namespace v3 {
extern const Kernels kernels;
}
namespace v4 {
extern const Kernels kernels;
}

}  // namespace scancast::cpu
