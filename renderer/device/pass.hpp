// Passes: what a method asks of a device. Three kinds exist (docs/spec/passes.md §2): `nearest` keeps the
// smallest 64-bit key per pixel, `sum` adds integer-quantised attributes, `screen` maps buffers to a buffer.
// All reductions are integers, so pictures do not depend on order: any thread count, any SIMD variant, any
// partition of the cloud. Plain values; devices know how to run them, methods only list them.
//
// A list reads: splat passes (SilhouettePass, NearestPass, CellPass, SumPass, in this order, all but
// NearestPass optional), one ResolvePass that turns what they left into planes of colour, depth and normal,
// then screen passes over those planes in any order that makes sense.
#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

namespace scancast {

/// What a splat covers. The pixel that contains its projected centre is always covered, at the centre's
/// depth.
enum class Footprint : std::uint8_t {
    Pixel,    ///< exactly one pixel
    Square,   ///< p × p px around the projected centre
    Circle,   ///< fragments with u² + v² ≤ 1
    Disc,     ///< the surfel's disc of radius r · scale in its tangent plane, exact in perspective
    Ellipse,  ///< the surfel's ellipse through a low-pass of the screen; docs/spec/surfels.md §4
};

/// Weight w(u,v) over the footprint, (u,v) ∈ [-1,1]²; docs/spec/sprites.md §3. Pixel, Square and Circle only.
enum class Profile : std::uint8_t {
    Flat,        ///< 1
    Paraboloid,  ///< 1 - (u² + v²)
    Cone,        ///< 1 - sqrt(u² + v²)
    Sphere,      ///< sqrt(1 - (u² + v²))
};

/// p = sizePx where that is > 0, else clamp(2·r·scale·q(d), minPx, maxPx); r = the sample's radius or,
/// without surfels, its node's spacing. Disc and Ellipse: `scale`, no diameter above maxPx, and in
/// perspective no radius above half the distance to the eye's plane (a sum's reach: 0.9 of it).
struct SplatSize {
    float sizePx = 0;
    float scale = 1;
    float minPx = 1;
    float maxPx = 50;
};

/// Which side of a surfel must face the eye for it to be drawn. Says nothing where normals are not oriented:
/// there both sides are the front.
enum class Facing : std::uint8_t { Any, Front, Back };

struct Splat {
    Footprint footprint = Footprint::Circle;
    Profile profile = Profile::Paraboloid;
    SplatSize size{};
    float gain = 2;               ///< profiles but Flat: how far the border lies behind the centre, in R
    float lowPassPx = 0.5f;       ///< Ellipse: σ of the screen's low-pass
    bool round = false;           ///< Ellipse: a circle of its larger half-axis; docs/spec/surfels.md §4.4
    Facing facing = Facing::Any;  ///< Disc, Ellipse
};

/// Whether a splat lies in its surfel's plane instead of facing the screen.
inline bool ofSurfels(const Splat& splat) {
    return splat.footprint == Footprint::Disc || splat.footprint == Footprint::Ellipse;
}

/// The 32 bits under a key's order. Where a SumPass needs to know of what is visible - surfels, or normals - devices put that
/// there instead (docs/spec/passes.md §2.2).
enum class Payload : std::uint8_t {
    Color,   ///< 8 bits of the fragment's distance to the splat's centre above RGB8 (b << 16 | g << 8 | r)
    Sample,  ///< the sample's ordinal in the cut: what the ResolvePass needs for normals
};

/// nearest: order = d + gain·(1-w)·R with R = (p/2)/q(d), the world radius of the clamped size; Disc: depth
/// of its plane; Ellipse: the plane's, clamped to d_c … d_c + dz (docs/spec/surfels.md §4.2). Key = bits(order) <<
/// 32 | payload. With dx, dy px from the projected centre to the pixel's, the 8 bits of distance are
/// trunc(127.5 · (dx² + dy²) / max(p/2, 1/2)²), which is monotone in the distance. A square covers -p/2 < dx,
/// dy ≤ p/2.
struct NearestPass : Splat {
    Payload payload = Payload::Color;
};

/// nearest over back-facing discs: fragments of later splat passes that lie behind are dropped. Nothing where
/// normals are not oriented.
struct SilhouettePass : Splat {};

/// nearest, Disc only: order = world distance to the disc's centre, at most r, also in the centre's own pixel; over the
/// fragments that lie no more than tolerance · r from what is visible, across the surface, and are of the right side of its
/// creases. What wins is the surface Voronoi cell; docs/spec/voronoi.md §2, §4.
struct CellPass : Splat {
    float tolerance = 0.5f;
};

/// sum: Σw·rgb, Σw and, if wanted, Σw·n over the fragments that lie at most a tolerance behind NearestPass'
/// depth d_vis. By footprint:
///   Circle   w = (1-(u²+v²))^1.5                        d ≤ d_vis + 2R          docs/spec/sprites.md §6
///   Ellipse  w = sqrt(|JΣJᵀ|/|V|)·exp(-½ xᵀV⁻¹x)        of its surface         docs/spec/surfels.md §4.3
///   Disc     w = 1-3t²+2t³, t = distance / (reach·r)    of its cell's surface   docs/spec/voronoi.md §3
/// A disc covers reach·r, and needs a CellPass.
/// Weights are integers 1 … 4095 inside the footprint. A circle or an ellipse must be no larger than the
/// NearestPass's: the selection grows nodes by that one alone.
struct SumPass : Splat {
    bool normals = false;
    /// Ellipse, with normals: they turn across the surfel as its curvatures say (docs/spec/surfels.md §12).
    bool curved = false;
    float reach = 2;
};

/// screen: what the splat passes left → colour, depth and, if wanted, normal; the background where no key is.
/// Depth is NearestPass' order. Colour and normal are those of the cell where there is a CellPass, else of
/// the nearest; with `sums` the means of SumPass instead, wherever Σw > 0.
struct ResolvePass {
    bool sums = false;
    bool normals = false;
    /// Normals that are looked up turn with the place on the surfel (docs/spec/surfels.md §12).
    bool curved = false;
    /// Paraboloids whose keys name samples: colours are blended across the border of two cells by how much of the pixel
    /// lies beyond it (docs/spec/sprites.md §9). Depth and normal stay the nearest's.
    bool smooth = false;
};

/// screen: two-sided Blinn-Phong by the plane of normals; docs/spec/shading.md §2. Pixels without a normal
/// stay.
struct PhongPass {
    float ambient = 0.5f;    ///< brightness = ambient + headlight · the lamp's light + sunlight · the sun's
    float headlight = 0.5f;  ///< a soft lamp over the viewer's left shoulder
    float sunlight = 0;
    float shine = 0.08f;                ///< of the headlight
    std::array<float, 3> sun{0, 0, 1};  ///< the way to it: cloud-relative, unit length
    bool shadows = false;               ///< of the sun: from the ShadowPass before it
};

/// screen: which pixels the sun sees, by what it sees (Drawing::sun); docs/spec/shading.md §10. Before a PhongPass, which
/// takes its sunlight from there; without one colours are darkened.
struct ShadowPass {
    float strength = 1;  ///< of the sunlight, so much is missing in the shadow
    float share = 0;     ///< of a colour, so much is the sun's; 0: colours are left to a PhongPass
    float bias = 0;      ///< cloud units: what is less in front does not shade
};

/// screen: eye-dome lighting from depth alone; docs/spec/shading.md §3.
struct EyeDomePass {
    float strength = 0.4f;
    float radiusPx = 1.4f;
};

/// screen: ambient occlusion from depth alone; docs/spec/shading.md §9.
struct OcclusionPass {
    float strength = 1;
    float radiusPx = 36;  ///< of the widest of its rings
};

/// screen, docs/spec/pyramid.md §4: labels pixels that other points occlude. s_eff = max(spacing,
/// 2·detail/q).
struct HiddenPointsPass {
    float scale = 10;        ///< hprScale: size of the neighbourhood, in s_eff
    float fixedPx = 0;       ///< hprPx: where > 0, its size everywhere, px
    float closing = 2;       ///< radius of the closing that makes background a hole, in s_eff
    float spacing = 0;       ///< s0, cloud units
    float detail = 1;        ///< τ, px
    float minGap = 0;        ///< cloud units: what is less in front does not occlude
    float threshold = 0.1f;  ///< mean occlusion below which a point is hidden
};

/// screen, docs/spec/pyramid.md §4.5: colours that tell what HiddenPointsPass found, in place of the points' own. Visible
/// background stays.
struct VisibilityPass {
    using Rgb = std::array<std::uint8_t, 3>;
    Rgb foreground{214, 69, 65};  ///< visible points
    Rgb hidden{63, 166, 77};      ///< points that others hide
    Rgb hole{49, 74, 122};        ///< background between points, which is filled
};

/// screen, docs/spec/pyramid.md §5: colour and depth of hidden and background pixels from their visible
/// neighbours; background that HiddenPointsPass labelled visible stays.
struct PullPushPass {};

/// screen, docs/spec/pyramid.md §6: normals of the filled depth.
struct DepthNormalsPass {
    float scale = 2;  ///< normalScale, in s_eff
    float spacing = 0;
    float detail = 1;
};

using Pass =
    std::variant<NearestPass, ResolvePass, EyeDomePass, OcclusionPass, SilhouettePass, SumPass, CellPass,
                 PhongPass, ShadowPass, HiddenPointsPass, PullPushPass, DepthNormalsPass, VisibilityPass>;
using PassList = std::vector<Pass>;

}  // namespace scancast
