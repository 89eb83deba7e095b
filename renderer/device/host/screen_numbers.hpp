// The numbers of screen passes, worked out once on the host (screens.hpp) and the same for every device, so that the same floats go into the same arithmetic. Plain
// structs of plain types and nothing else, because SIMD kernels include this (decision 2); shaders get them
// as layouts_screen.glsl packs them.
#pragma once

#include <cstdint>

namespace scancast {

/// Blinn-Phong over planes.
struct PhongNumbers {
    bool perspective = true;
    std::int32_t x = 0, y = 0;       ///< the planes' first pixel, in the picture
    float offsetX = 0, offsetY = 0;  ///< centre of the picture's pixel (0, 0), px right of and below the axis
    float inverseFocal = 0;          ///< 1/f
    float ambient = 0, headlight = 0, sunlight = 0, shine = 0;
    float sun[3] = {0, 0, 1};  ///< the way to it, view space
};

/// Eye-dome lighting.
struct EyeDomeNumbers {
    std::int32_t x[8] = {}, y[8] = {};  ///< of the neighbours, px from a pixel
    std::int32_t reach = 0;             ///< none is farther on an axis
    float factor = 0;                   ///< shade = 2^(-factor · sum of the eight responses)
};

/// Ambient occlusion: pairs of opposite neighbours on rings around a pixel.
inline constexpr int occlusionRings = 6, linesPerRing = 4, occlusionPairs = occlusionRings * linesPerRing;
/// Neighbours that rise above a pixel by this many of their distances occlude it in full; by 1/occlusionFall more, not
/// at all: they stand before it.
inline constexpr float occlusionFull = 1.5f, occlusionFall = 0.4f;

struct OcclusionNumbers {
    bool perspective = true;
    std::int32_t x[occlusionPairs] = {},
                 y[occlusionPairs] = {};  ///< of one of each pair, px; the other is opposite
    float perPx[occlusionPairs] = {};  ///< slope = difference of nearness · depth (orthographic: 1) · perPx
    std::int32_t reach = 0;            ///< none is farther on an axis
    float factor = 0;                  ///< shade = 2^(-factor · sum over the pairs)
};

/// Shadows. Where a pixel (x, y) of depth d lies in the map, px, and how deep: in perspective d · (a[0] + a[1] · x +
/// a[2] · y) + a[3], else a[0] + a[1] · x + a[2] · y + a[3] · d.
struct ShadowNumbers {
    bool perspective = true;
    std::int32_t x = 0, y = 0;  ///< the planes' first pixel, in the picture
    float u[4] = {}, v[4] = {}, depth[4] = {};
    std::int32_t mapWidth = 0, mapHeight = 0;
    float strength = 0, share = 0, bias = 0;  ///< ShadowPass
};

/// A mirror's glass. What is linear in the picture's pixel (x, y), at its centre, is given as value at (0,
/// 0), step in x, step in y. Without perspective: the depth of the mirror's plane, and the place on it, -1 …
/// 1 on the glass. In perspective depth is 1/depth, and places are divided by the depth. The glass is seen
/// unless the scene lies further than `margin` in front of it.
struct GlassNumbers {
    bool perspective = true;
    float depthAt[3] = {}, rightAt[3] = {}, upAt[3] = {};
    float margin = 0;
    std::int32_t tint[3] = {255, 255, 255};
};

/// Level 0 of a pyramid is the picture; level k has half the size of level k - 1, rounded up. A texel is a
/// value of a coarser level.
inline constexpr int maxPyramidLevels = 24;
/// The depth that chooses a pixel's neighbourhood comes from level 4: one for 16 × 16 pixels.
inline constexpr int blockLevel = 4;
inline constexpr int blockSize = 1 << blockLevel;

/// How a pixel and its depth d become a point, x right, y up: (px - centerX) · step (· d in perspective).
struct Unprojection {
    bool perspective = true;
    float step = 1;                  ///< 1/f in perspective, else 1/q
    float centerX = 0, centerY = 0;  ///< the view axis, px from the planes' left and top edges
};

/// The widest radius of a closing of the background, px.
inline constexpr int widestClosing = 32;

/// The radius of a closing at a depth d in eighths of a pixel: scaled / d (orthographic: scaled), from `least` to `most`,
/// without its fraction. docs/spec/pyramid.md §4.4.
struct ClosingSize {
    static constexpr float most = 16 * widestClosing, nearest = 1e-15f;
    float scaled = 0, least = 0;
};

/// What hidden point removal finds of a pixel.
inline constexpr std::uint8_t hiddenLabel = 0, foregroundLabel = 1, backgroundLabel = 2;

}  // namespace scancast
