// Passes: what a method asks of a device. Three kinds exist (methods.md §2): `nearest` keeps the smallest
// 64-bit key per pixel, `sum` adds integer-quantised attributes, `screen` maps buffers to a buffer. All
// reductions are integers, so pictures do not depend on order: any thread count, any SIMD variant, any
// partition of the cloud. Plain values; devices know how to run them, methods only list them.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

namespace scancast {

/// What a splat covers. The pixel that contains its projected centre is always covered, at the centre's
/// depth.
enum class Footprint : std::uint8_t {
    Pixel,   ///< exactly one pixel
    Square,  ///< p × p px around the projected centre
    Circle,  ///< fragments with u² + v² ≤ 1
};

/// Weight w(u,v) over the footprint, (u,v) ∈ [-1,1]²; methods.md §3.
enum class Profile : std::uint8_t {
    Flat,        ///< 1
    Paraboloid,  ///< 1 - (u² + v²)
    Cone,        ///< 1 - sqrt(u² + v²)
    Sphere,      ///< sqrt(1 - (u² + v²))
};

/// p = sizePx where that is > 0, else clamp(2·r·scale·q(d), minPx, maxPx); r = the sample's radius or,
/// without surfels, its node's spacing.
struct SplatSize {
    float sizePx = 0;
    float scale = 1;
    float minPx = 1;
    float maxPx = 50;
};

/// nearest: order = d + gain·(1-w)·R with R = (p/2)/q(d), the world radius of the clamped size. Key =
/// bits(order) << 32 | payload; the payload is 8 bits of the fragment's distance to the splat's centre above
/// RGB8 (b << 16 | g << 8 | r). With dx, dy px from the projected centre to the pixel's: the 8 bits are
/// trunc(127.5 · (dx² + dy²) / max(p/2, 1/2)²), which is monotone in the distance. A square covers -p/2 < dx,
/// dy ≤ p/2.
struct NearestPass {
    Footprint footprint = Footprint::Circle;
    Profile profile = Profile::Paraboloid;
    SplatSize size;
    float gain = 2;
};

/// screen: nearest keys → colour and depth; the background where no key is.
struct ResolvePass {};

/// screen: eye-dome lighting from depth alone; methods.md §9.
struct EyeDomePass {
    float strength = 0.4f;
    float radiusPx = 1.4f;
};

using Pass = std::variant<NearestPass, ResolvePass, EyeDomePass>;
using PassList = std::vector<Pass>;

}  // namespace scancast
