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

#include "renderer/device/cpu/kernels/pyramid.hpp"
#include "renderer/device/host/splat_numbers.hpp"

namespace scancast::cpu {

/// Samples are read as four 32-bit words: x | y << 16, z | intensity << 16, rgb | class << 24, normal | ….
using SampleWords = std::uint32_t[4];

/// order << 32 | payload (pass.hpp). Orders are positive floats, so signed comparison sorts keys.
using Key = std::int64_t;
/// Bits of +infinity; an order at or above it means "no splat here".
inline constexpr std::int32_t infiniteOrder = 0x7f800000;
/// Such an order; not a number, so that no comparison of depths holds. Keys with it are numbers if taken for doubles, as all
/// keys are: these sort in the same order, and processors have an instruction for the smaller of two.
inline constexpr std::int32_t emptyOrder = 0x7fbfffff;
inline constexpr Key emptyKey = Key{emptyOrder} << 32 | 0xffffffff;

using Shape = SplatShape;
using Coloring = SplatColoring;

/// renderer/cloud/sample_limits.hpp, of limitsStep samples in a row.
struct BlockLimits {
    std::uint16_t low[3], high[3];
    std::uint8_t largestRadius;
    std::uint8_t plain;
    std::uint16_t unused;
};
inline constexpr std::uint32_t limitsStep = 64;

/// One run of samples, made ready on the host in double.
struct SplatRun : RunNumbers {
    const SampleWords* samples = nullptr;   ///< the first one's ordinal is firstOrdinal
    const BlockLimits* limits = nullptr;    ///< of the samples, or null; samples[0] begins one
    const std::uint32_t* beside = nullptr;  ///< of the samples (renderer/cloud/sample.hpp), or null
    std::uint32_t count = 0;
    /// p = clamp(sizeFactor · ratio (/ d in perspective), minPx, maxPx).
    float sizeFactor = 0;
    float largestRatio = 1;              ///< no ratio of the run is larger
    float largestPx = 0;                 ///< no splat of the run is larger, in this pass
    bool crossesTile = true;             ///< some of it lies in other tiles
    const RunRegion* regions = nullptr;  ///< first those in which samples are dropped
    std::int32_t droppedCount = 0;
    std::int32_t keptCount =
        0;  ///< those after them: in one at least every sample must lie, where there are any
};

/// A tile of the picture being drawn by one thread. `keys` points at its pixel (0, 0) inside a larger block:
/// splats of up to guardPx pixels may write `guard` pixels beyond every side without asking.
struct KeyTile {
    Key* keys = nullptr;
    Key* unused = nullptr;      ///< unusedKeys words of nobody, for what falls outside
    std::int32_t stride = 0;    ///< keys per row
    std::int32_t x = 0, y = 0;  ///< its place in the whole picture
    std::int32_t width = 0, height = 0;
    /// Sum and Cell: keys of the NearestPass, same geometry.
    const Key* visible = nullptr;
    /// Sum: keys whose payloads are the surfaces there: the cells' where there are any, else the same.
    const Key* surfaces = nullptr;
    /// Fragments behind these keys' orders are dropped; null: no SilhouettePass.
    const Key* silhouette = nullptr;
    /// Sum: planes of Σw, Σw·r, Σw·g, Σw·b and, with normals, Σw·x, Σw·y, Σw·z of the view-space normal
    /// times normalSteps; planeSize apart, each with the geometry of the keys.
    std::int32_t* sums = nullptr;
    std::int64_t planeSize = 0;
};

/// The same tile of one of the frames that are averaged: they differ in where the view axis lies, px in the whole picture.
struct FrameTile {
    float centerX = 0, centerY = 0;
    KeyTile tile;
};
/// So many frames are drawn at once, at most.
inline constexpr int mostFrames = 4;

inline constexpr int colorPlanes = 4, normalPlanes = 3;
inline constexpr int largestWeight = 4095;
/// A colour has 8 bits; normals get as many and a sign, so all planes overflow together.
inline constexpr float normalSteps = 255;
/// Before Σw·255 could overflow: a block adds at most 2^20 to what is still below.
inline constexpr std::int32_t fullSum = 1 << 23;
inline constexpr int guard = 16;
inline constexpr int unusedKeys = 64;
/// Larger splats are clipped row by row.
inline constexpr float guardPx = 8;

/// Whose paraboloid each pixel shows (docs/spec/sprites.md §9); planes with the same geometry.
struct Owners {
    std::uint32_t* places = nullptr;  ///< x | y << 16, as placeSteps counts
    float* halves = nullptr;          ///< half the splat's size, px
    float* orders = nullptr;          ///< +infinity = background
    std::uint32_t* colors = nullptr;
    std::int32_t stride = 0;  ///< pixels per row
};

/// Smooths the borders of some rows. Every pixel has its four neighbours in `owners`, and as many more at a row's end as are
/// read at once.
struct Smoothing {
    Owners owners;  ///< places of the first row's first pixel
    bool perspective = true;
    bool square = false;  ///< what splats cover
    float bulge =
        0;  ///< how far the border lies behind the centre, over half a splat's size in px (and over depth)
    std::uint32_t* rgba = nullptr;
    std::int32_t stride = 0;
    std::int32_t width = 0, height = 0;
};

/// Where resolved pixels go: place of its first pixel, and background per row of the tile.
struct PixelTile {
    std::uint32_t* rgba = nullptr;
    float* depth = nullptr;                     ///< null: not wanted
    std::uint32_t* normals = nullptr;           ///< as normal_plane.hpp packs them; null: not wanted
    std::int32_t stride = 0;                    ///< pixels per row
    const std::uint32_t* background = nullptr;  ///< one rgba per row
    Owners owners;                              ///< null: not wanted
};

/// From an ordinal to its sample: the runs by ordinal, and for every 2^shift ordinals where to begin to look.
struct SampleTable {
    const SplatRun* runs = nullptr;
    std::uint32_t count = 0;
    const std::uint32_t* runAt = nullptr;
    int shift = 0;
};

/// Blinn-Phong lighting of the rows [row0, row1) of some planes, in place.
struct Phong : PhongNumbers {
    std::uint32_t* rgba = nullptr;  ///< of row 0
    const std::uint32_t* normals = nullptr;
    std::int32_t stride = 0;  ///< pixels per row, of both
    std::int32_t width = 0, row0 = 0, row1 = 0;
    const float* sunSeen = nullptr;  ///< 0 - 1, as wide as the others; null: no shadows
};

/// Shadows over the rows [row0, row1) of some planes, in place.
struct Shadow : ShadowNumbers {
    const float* map = nullptr;     ///< depths from the sun, row by row; +infinity = nothing
    std::uint32_t* rgba = nullptr;  ///< of row 0, as all planes
    const float* depths = nullptr;
    float* sunlight = nullptr;
    std::int32_t stride = 0;  ///< pixels per row, of all three
    std::int32_t width = 0, row0 = 0, row1 = 0;
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

/// Ambient occlusion of some rows, in place. Every pixel has all its neighbours in `nearness`.
struct Occlusion : OcclusionNumbers {
    const float* nearness = nullptr;  ///< of the first row's first pixel; -infinity = background
    std::int32_t nearStride = 0;
    const float* depth = nullptr;
    std::uint32_t* rgba = nullptr;
    std::int32_t stride = 0;  ///< pixels per row, of both
    std::int32_t width = 0, height = 0;
    std::int32_t offsets[occlusionPairs] = {};  ///< of one of each pair, in `nearness`
};

/// A mirror's glass over some rows of a picture.
struct Glass : GlassNumbers {
    std::uint32_t* rgba = nullptr;
    float* depth = nullptr;
    std::uint32_t* normals = nullptr;  ///< null: there are none
    std::int32_t stride = 0;           ///< pixels per row
    const std::uint32_t* reflected = nullptr;
    const float* reflectedDepth = nullptr;
    const std::uint32_t* reflectedNormals = nullptr;
    std::int32_t reflectedStride = 0;
    std::int32_t x = 0, y = 0;  ///< of the first pixel, in the whole picture
    std::int32_t width = 0, height = 0;
};

/// The kernels of one SIMD level.
struct Kernels {
    void (*clear)(const KeyTile&);
    /// How many samples of the run are done. Less than all only for sums: then some pixel is nearly full
    /// (fullSum), and the planes must be emptied before the rest follows.
    std::uint32_t (*splat)(const SplatPass&, const SplatRun&, const KeyTile&);
    /// Sprites, nearest, into all of these: samples are read, filtered, coloured and projected once.
    void (*splatFrames)(const SplatPass&, const SplatRun&, const FrameTile* frames, int count);
    /// Whether every pixel of [x0, x1) × [y0, y1) (tile-relative) already lies in front of an order of these
    /// bits.
    bool (*hidden)(const KeyTile&, int x0, int y0, int x1, int y1, std::int32_t orderBits);
    /// Payloads are colours.
    void (*resolve)(const KeyTile&, const PixelTile&);
    /// Payloads are ordinals; depth is `visible`'s where that is set. `pass` says how to colour.
    void (*resolveSamples)(const SplatPass& pass, const SampleTable&, const KeyTile&, const PixelTile&);
    /// Means instead of what is there, wherever there is a key and Σw > 0. `wide`: sums that were emptied
    /// before, in planes like the tile's, or null.
    void (*resolveSums)(const KeyTile&, const std::int64_t* wide, const PixelTile&);
    void (*smooth)(const Smoothing&);
    void (*phong)(const Phong&);
    void (*shadow)(const Shadow&);
    void (*logDepth)(const float* depth, float* out, int count);
    void (*eyeDome)(const EyeDome&);
    void (*nearness)(const float* depth, bool perspective, float* out, int count);
    void (*occlude)(const Occlusion&);
    /// Where the glass is seen: the reflected pixels instead of what is there, at their own depth.
    void (*lookThrough)(const Glass&);
    /// Where the glass is seen: its tint, and its own depth.
    void (*tintGlass)(const Glass&);
    /// sums[i] += rgba's bytes.
    void (*accumulate)(const std::uint8_t* rgba, std::uint16_t* sums, int bytes);
    /// The mean of `frames` pictures whose sums these are: colour weighted by coverage, straight alpha.
    void (*average)(const std::uint16_t* sums, std::uint8_t* rgba, int pixels, int frames);
    PyramidKernels pyramid;
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
