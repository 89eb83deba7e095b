// Surfels of a block made ready to be drawn: from a sample's four bytes to a few numbers that every fragment
// is two linear functions of. Structures of arrays, a vector of surfels at a time. Part of kernels.cpp.
//
// Frame: the picture's own, x right, y down, z away from the eye, so depth is z. The ray through a pixel is
// (u, v, 1) · depth in perspective, with u, v = px from the view axis / f; without perspective it is along z.
// With N the normal, m = N · (u, v, 1) at the centre and dx, dy the px from there, a disc's plane is met at
// depth d / c, c = 1 + (N.x·dx + N.y·dy) / (f·m), and the place on the disc, in radii, is (s, t) / c with s,
// t linear in dx, dy. Along t the depth changes, along s it does not; hence c = 1 + slope · t. Nothing
// cancels, however grazing the view.
#pragma once

#include "renderer/device/cpu/kernels/bends.hpp"
#include "renderer/device/cpu/kernels/project.hpp"
#include "renderer/device/cpu/kernels/surfaces.hpp"
#include "renderer/device/cpu/kernels/surfel_codes.hpp"
#include "renderer/device/cpu/kernels/view_normals.hpp"
#include "renderer/device/host/splat_numbers.hpp"

namespace scancast::cpu {
namespace {

/// A surfel is not drawn smaller (in half px): what divides by its size stays finite. Its centre's pixel is
/// drawn anyway.
inline constexpr float leastHalf = 1e-3f;
/// A plane seen more edge-on than this is treated as if it were this much open.
inline constexpr float leastCosine = 1e-4f;

/// Surfels in a block: fewer than sprites, since each takes more room in the cache, and small blocks are more
/// often found to be hidden.
inline constexpr int surfelBlock = 64;
static_assert(surfelBlock <= blockSize && surfelBlock == limitsStep);
/// Not a power of two, so that the arrays of a block do not compete for the same lines of the cache.
inline constexpr int surfelRow = surfelBlock + 16;

/// A block's surfels, as the fragments need them.
struct alignas(64) Surfels {
    std::int32_t x0[surfelRow], y0[surfelRow], x1[surfelRow], y1[surfelRow];  ///< pixels, inclusive
    /// Outline: row y is covered around middleX + skew · (y - middleY), by narrow · sqrt(1 - ((y - middleY) ·
    /// inverseY)²) on both sides; px from the centre.
    float middleX[surfelRow], middleY[surfelRow], inverseY[surfelRow], skew[surfelRow], narrow[surfelRow];
    /// Place on the surfel: s = sx·dx + sy·dy, t = tx·dx + ty·dy; Ellipse: tx = 0, units of √6 σ.
    float sx[surfelRow], sy[surfelRow], tx[surfelRow], ty[surfelRow];
    /// Disc: c = 1 + slopeX · t, or depth = d + slopeX · t without perspective. Ellipse: c = 1 + slopeX·dx +
    /// slopeY·dy, or depth = d + …, kept within [low, high]: not before the centre.
    float slopeX[surfelRow], slopeY[surfelRow], low[surfelRow], high[surfelRow];
    float radius[surfelRow];     ///< Disc: cloud units covered; Ellipse: half of the larger axis, px
    float tolerance[surfelRow];  ///< Disc: cloud units along the ray; Ellipse: px
    float sheet[surfelRow];      ///< Disc: the same of what faces the same way
    float half[surfelRow];       ///< Disc: drawn radius, px
    /// No fragment counts where the visible depth is nearer than this; a little less than exact.
    float front[surfelRow];
    float peak[surfelRow];                                             ///< Ellipse: weight at the centre
    float distance[surfelRow];                                         ///< 8 bits of distance = this · px²
    float normalX[surfelRow], normalY[surfelRow], normalZ[surfelRow];  ///< view space, (0, 0, 0) = none
    bool bends = false;  ///< what follows, up to `bent`, is known
    /// How the normal turns, per px to the right and down.
    float bendRight[3][surfelRow], bendDown[3][surfelRow];
    std::int32_t bent[surfelRow];     ///< -1: it does
    std::int32_t surface[surfelRow];  ///< formulas/constants.inl; its normal turned to the eye
    std::int32_t anySide[surfelRow];  ///< -1: its normal may be turned
    std::int32_t reaches[surfelRow];
    std::uint16_t list[surfelRow];  ///< those that reach into the tile
    int count = 0;
};

/// One vector of surfels, seen.
struct Pose {
    FloatW cloudX, cloudY, cloudZ;  ///< the normal before it is turned into view space
    FloatW x, y, z;                 ///< unit normal
    FloatW u, v, m;                 ///< as above
    FloatW flat;                    ///< length of the normal's part across the view axis
    FloatW acrossX, acrossY;        ///< its direction
    FloatW half;                    ///< drawn radius, px, as if facing the viewer
    FloatW unitsPerPx;              ///< 1/q
    IntW hasNormal, drawn;
};

/// px of a radius of `radius` cloud units, within what may be drawn.
template <bool perspective>
inline FloatW halfPixels(const SplatPass& pass, FloatW radius, FloatW depth) {
    float most = 0.5f * pass.maxPx;
    if (perspective && most > largestSpread * pass.pixelsPerUnit) most = largestSpread * pass.pixelsPerUnit;
    FloatW px = radius * pass.pixelsPerUnit;
    if (perspective) px = px / depth;
    return larger(smaller(px, all(most)), all(leastHalf));
}

inline void setNormal(const SplatPass& pass, const Block& b, int i, Pose& p) {
    sampleNormal(load<IntW>(b.words[3] + i) & 0xffff, p.x, p.y, p.z);
    p.cloudX = p.x;
    p.cloudY = p.y;
    p.cloudZ = p.z;
    p.hasNormal = (p.x != 0.0f) | (p.y != 0.0f) | (p.z != 0.0f);
    rotateToView(pass, p.x, p.y, p.z);
    // Without a normal: facing the screen.
    p.y = -p.y;
    p.z = p.hasNormal ? -p.z : all(-1.0f);
}

/// Which of them are circles that may point to either side (renderer/cloud/surfel_bytes.hpp).
inline IntW twoSided(const Block& b, int i) {
    return (load<IntW>(b.words[3] + i) >> 24 & 255) == twoSidedCircle;
}

/// Which of them are drawn, by the side that faces the eye.
inline IntW drawnOf(const SplatPass& pass, const SplatRun& run, const Block& b, int i, const Pose& p) {
    const IntW drawn = load<IntW>(b.drawable + i);
    if (pass.facing == 0) return drawn;
    const IntW faces = run.oriented ? (p.m <= 0.0f) | ~p.hasNormal | twoSided(b, i) : all(-1);
    return drawn & (pass.facing > 0 ? faces : ~faces);
}

template <bool perspective>
inline Pose poseOf(const SplatPass& pass, const SplatRun& run, const Block& b, int i, FloatW radiusFactor) {
    Pose p;
    setNormal(pass, b, i, p);
    p.u = p.v = all(0.0f);
    const float pixel = 1.0f / pass.pixelsPerUnit;
    p.unitsPerPx = all(pixel);
    if constexpr (perspective) {
        p.u = (load<FloatW>(b.x + i) - pass.centerX) * pixel;
        p.v = (load<FloatW>(b.y + i) - pass.centerY) * pixel;
        p.unitsPerPx = load<FloatW>(b.depth + i) * pixel;
    }
    p.m = p.x * p.u + p.y * p.v + p.z;
    p.drawn = drawnOf(pass, run, b, i, p);
    p.m = p.m < 0.0f ? smaller(p.m, all(-leastCosine)) : larger(p.m, all(leastCosine));
    p.flat = squareRoot<wideLanes>(p.x * p.x + p.y * p.y);
    const IntW facing = p.flat < 1e-6f;
    const FloatW inverse = 1.0f / (facing ? all(1.0f) : p.flat);
    p.acrossX = facing ? all(1.0f) : p.x * inverse;
    p.acrossY = facing ? all(0.0f) : p.y * inverse;
    const float unit = run.plainRadius * pass.scale;
    p.half = halfPixels<perspective>(pass, (unit * load<FloatW>(b.ratio + i)) * radiusFactor,
                                     load<FloatW>(b.depth + i));
    return p;
}

/// The outline: middle, and the matrix V of its second moments (halfX² = vxx).
struct Outline {
    FloatW middleX, middleY, vxx, vxy, vyy;
};

inline void storeOutline(const Block& b, int i, const Outline& o, Surfels& s) {
    const FloatW halfX = squareRoot<wideLanes>(larger(o.vxx, all(0.0f)));
    const FloatW halfY = squareRoot<wideLanes>(larger(o.vyy, all(leastHalf * leastHalf)));
    const FloatW inverseY = 1.0f / halfY;
    const FloatW skew = (o.vxy * inverseY) * inverseY;
    store(s.middleX + i, o.middleX);
    store(s.middleY + i, o.middleY);
    store(s.inverseY + i, inverseY);
    store(s.skew + i, skew);
    store(s.narrow + i, squareRoot<wideLanes>(larger(o.vxx - o.vxy * skew, all(0.0f))));
    // Pixels whose centres lie inside, and the one that holds the surfel's centre.
    const FloatW x = load<FloatW>(b.x + i), y = load<FloatW>(b.y + i);
    const FloatW column = floorOf(x), row = floorOf(y);
    const auto bounded = [](FloatW v) { return larger(smaller(v, all(4194304.0f)), all(-4194304.0f)); };
    const auto first = [&](FloatW border, FloatW center) {
        return toInt(smaller(-floorOf(bounded(0.5f - border)), center));
    };
    const auto last = [&](FloatW border, FloatW center) {
        return toInt(larger(floorOf(bounded(border - 0.5f)), center));
    };
    store(s.x0 + i, first(x + (o.middleX - halfX), column));
    store(s.x1 + i, last(x + (o.middleX + halfX), column));
    store(s.y0 + i, first(y + (o.middleY - halfY), row));
    store(s.y1 + i, last(y + (o.middleY + halfY), row));
}

/// `above`: bits over its normal's.
inline void storeCommon(const SplatPass& pass, const SplatRun& run, const Block& b, int i, const Pose& p,
                        IntW above, Surfels& s) {
    // Ordinals take all 32 bits: no distance then. Sums have no keys.
    if (pass.payload == SplatPayload::Color && pass.reduction == Reduction::Nearest) {
        const FloatW atLeastAPixel = larger(p.half, all(0.5f));
        store(s.distance + i, 127.5f / (atLeastAPixel * atLeastAPixel));
    }
    if (pass.reduction == Reduction::Nearest && pass.payload != SplatPayload::Surface) return;
    // Turned to the eye unless a side is known; in view space y is up and z towards the viewer.
    const IntW anySide = run.oriented ? twoSided(b, i) : all(-1);
    const FloatW turn = (p.m > 0.0f) & anySide ? all(-1.0f) : all(1.0f);
    const FloatW x = p.x * turn, y = -(p.y * turn), z = -(p.z * turn);
    // Discs meet as the eye sees them, from whichever side.
    const FloatW seen = p.m > 0.0f ? all(-1.0f) : all(1.0f);
    const bool disc = pass.shape == SplatShape::Disc;
    store(s.surface + i,
          normalBytes(disc ? p.x * seen : x, disc ? -(p.y * seen) : y, disc ? -(p.z * seen) : z) | above);
    store(s.anySide + i, anySide);
    if (pass.reduction == Reduction::Cell) {
        store(s.normalX + i, p.x * seen);
        store(s.normalY + i, -(p.y * seen));
        store(s.normalZ + i, -(p.z * seen));
    } else if (pass.sumNormals) {
        store(s.normalX + i, p.hasNormal ? x : all(0.0f));
        store(s.normalY + i, p.hasNormal ? y : all(0.0f));
        store(s.normalZ + i, p.hasNormal ? z : all(0.0f));
    }
}

/// `range`: how far in front of its centre's a fragment's depth may lie.
inline void storeFront(const SplatPass& pass, FloatW depth, FloatW range, FloatW tolerance, int i,
                       Surfels& s) {
    const FloatW front = pass.reduction == Reduction::Nearest ? depth - range : (depth - range) - tolerance;
    store(s.front + i, front - 1e-4f * depth);
}

/// The disc's outline, from its dual conic: with e = (half/f)² and S the projector onto its plane seen in
/// the frame of the ray, the middle lies at -e·f·S.z / (1 - e·S.zz).
template <bool perspective>
inline Outline discOutline(const SplatPass& pass, const Pose& p, FloatW half) {
    const FloatW x = p.x - p.u * p.z, y = p.y - p.v * p.z;
    const FloatW xx = 1.0f + p.u * p.u - x * x, yy = 1.0f + p.v * p.v - y * y, xy = p.u * p.v - x * y;
    const FloatW h2 = half * half;
    if constexpr (!perspective) return {all(0.0f), all(0.0f), h2 * xx, h2 * xy, h2 * yy};
    const float pixel = 1.0f / pass.pixelsPerUnit;
    const FloatW e = h2 * (pixel * pixel);
    const FloatW grown = h2 / (1.0f - e * (1.0f - p.z * p.z));
    const FloatW middleX = (grown * pixel) * (p.u + x * p.z), middleY = (grown * pixel) * (p.v + y * p.z);
    return {middleX, middleY, middleX * middleX + grown * larger(xx, all(0.0f)),
            middleX * middleY + grown * xy, middleY * middleY + grown * larger(yy, all(0.0f))};
}

template <bool perspective>
void setUpDiscs(const SplatPass& pass, const SplatRun& run, const Block& b, Surfels& s) {
    const bool extended = pass.reduction == Reduction::Sum;
    const float most = largestReach * pass.pixelsPerUnit, pixel = 1.0f / pass.pixelsPerUnit;
    for (int i = 0; i < b.padded; i += wideLanes) {
        const Pose p = poseOf<perspective>(pass, run, b, i, all(1.0f));
        FloatW half = p.half;
        if (extended) half = half * pass.reach;
        if (extended && perspective) half = smaller(half, all(most));
        const FloatW inverse = 1.0f / (half * p.m);
        store(s.sx + i, (p.v * p.flat + p.acrossY * p.z) * inverse);
        store(s.sy + i, -((p.u * p.flat + p.acrossX * p.z) * inverse));
        store(s.tx + i, p.acrossX * inverse);
        store(s.ty + i, p.acrossY * inverse);
        const FloatW radius = half * p.unitsPerPx;
        const FloatW slope = p.flat * half;
        store(s.slopeX + i, perspective ? slope * pixel : -(slope * p.unitsPerPx));
        store(s.radius + i, radius);
        // Of another direction, across the surface: along the ray it is more.
        const FloatW open = smaller(larger(p.m < 0.0f ? -p.m : p.m, all(leastCosineOfGap)), all(1.0f));
        const FloatW sheet = pass.tolerance * (p.half * p.unitsPerPx);
        const FloatW tolerance = sheet / open;
        store(s.tolerance + i, tolerance);
        store(s.sheet + i, sheet);
        store(s.half + i, p.half);
        // D = d / c ≥ d · (1 - slope), since |t| ≤ c.
        const FloatW d = load<FloatW>(b.depth + i);
        const FloatW range = perspective ? (d * slope) * pixel : slope * p.unitsPerPx;
        storeFront(pass, d, range, tolerance, i, s);
        store(s.reaches + i, p.drawn);
        storeOutline(b, i, discOutline<perspective>(pass, p, half), s);
        storeCommon(pass, run, b, i, p, all(0), s);
    }
}

/// Half-axes in px, in the picture: what a step along the axis moves there.
struct Axes {
    FloatW ax, ay, az, bx, by, bz;
};

inline Axes axesOf(const SplatPass& pass, const AxisCodes& codes, int i, const Pose& p) {
    FloatW x, y, z;
    majorAxis(p.cloudX, p.cloudY, p.cloudZ, codes, i, x, y, z);
    rotateToView(pass, x, y, z);
    x = p.hasNormal ? x : all(1.0f);
    y = p.hasNormal ? -y : all(0.0f);
    z = p.hasNormal ? -z : all(0.0f);
    const FloatW minor = p.half * load<FloatW>(codes.ratio + i);
    return {p.half * x,
            p.half * y,
            p.half * z,
            minor * (p.y * z - p.z * y),
            minor * (p.z * x - p.x * z),
            minor * (p.x * y - p.y * x)};
}

/// How far a fragment may lie behind its centre, px: a surfel's own extent, since nothing is known of the surface where the
/// screen's low-pass alone reaches. None lies before it: what is seen edge-on would stand out of its surface, and the back of
/// a thing before its front.
inline FloatW depthRange(const Axes& a) {
    return squareRoot<wideLanes>(a.az * a.az + a.bz * a.bz);
}

/// px behind it that are of its surface: what it covers itself, and what the low-pass takes in of its plane.
inline FloatW ellipseTolerance(const SplatPass& pass, const Pose& p, FloatW range) {
    const FloatW steep = p.z < 0.0f ? -p.z : p.z;
    const FloatW slope = p.flat < 8.0f * steep ? p.flat / larger(steep, all(0.1f)) : all(8.0f);
    const FloatW blur = (rootOf6 * pass.lowPassPx) * slope;
    return 2.0f * (p.half + squareRoot<wideLanes>(range * range + blur * blur));
}

/// The normals of ellipses turn linearly over the picture, as their footprints are one linear step from the surface to it: the
/// place on the surface of a pixel (dx, dy) from the centre is (dx, dy, 0) - (u, v, 1) · (N.x·dx + N.y·dy) / m, in units a px.
/// Less so by the low-pass' share: what that takes in is not theirs. `turn`: 1, or -1 where the normal was turned.
inline void storeBends(const SplatPass& pass, const SplatRun& run, const Block& b, std::uint32_t firstCode,
                       int i, const Pose& p, FloatW share, Surfels& s) {
    BendCodes codes;
    std::uint32_t any = 0;
    for (int l = 0; l < wideLanes; ++l) {
        const std::uint32_t code =
            i + l < b.count ? run.beside[firstCode + static_cast<std::uint32_t>(i + l)] & curvatureBits : 0;
        decodeBend(pass, code, l, codes);
        any |= code;
    }
    if (any == 0) return store(s.bent + i, all(0));
    const FloatW x = p.x, y = -p.y, z = -p.z;
    const Bend e = bendOf(pass, p.cloudX, p.cloudY, p.cloudZ, x, y, z, codes, all(bendsPerUnit(run)));
    const IntW anySide = run.oriented ? twoSided(b, i) : all(-1);
    const FloatW turn = (p.m > 0.0f) & anySide ? all(-1.0f) : all(1.0f);
    const FloatW per = (share * p.unitsPerPx) * turn;
    const FloatW overM = 1.0f / p.m;
    // Directions in the picture's frame, where y is down and z away.
    const FloatW along1 = ((e.x1 * p.u - e.y1 * p.v) - e.z1) * overM;
    const FloatW along2 = ((e.x2 * p.u - e.y2 * p.v) - e.z2) * overM;
    const FloatW k1 = e.k1 * per, k2 = e.k2 * per;
    const FloatW right1 = k1 * (e.x1 - along1 * p.x), right2 = k2 * (e.x2 - along2 * p.x);
    const FloatW down1 = k1 * (-e.y1 - along1 * p.y), down2 = k2 * (-e.y2 - along2 * p.y);
    store(s.bendRight[0] + i, right1 * e.x1 + right2 * e.x2);
    store(s.bendRight[1] + i, right1 * e.y1 + right2 * e.y2);
    store(s.bendRight[2] + i, right1 * e.z1 + right2 * e.z2);
    store(s.bendDown[0] + i, down1 * e.x1 + down2 * e.x2);
    store(s.bendDown[1] + i, down1 * e.y1 + down2 * e.y2);
    store(s.bendDown[2] + i, down1 * e.z1 + down2 * e.z2);
    store(s.bent + i, p.hasNormal & ((e.k1 != 0.0f) | (e.k2 != 0.0f)));
}

template <bool perspective>
void setUpEllipses(const SplatPass& pass, const SplatRun& run, std::uint32_t first, const Block& b,
                   Surfels& s) {
    AxisCodes codes;
    decodeAxes(pass, b, codes);
    s.bends = pass.curved && pass.sumNormals && run.beside != nullptr;
    const float blur2 = 6.0f * pass.lowPassPx * pass.lowPassPx;
    const float pixel = 1.0f / pass.pixelsPerUnit;
    for (int i = 0; i < b.padded; i += wideLanes) {
        const Pose p = poseOf<perspective>(pass, run, b, i, load<FloatW>(codes.major + i));
        const Axes a = axesOf(pass, codes, i, p);
        const FloatW ax = a.ax - p.u * a.az, ay = a.ay - p.v * a.az;
        const FloatW bx = a.bx - p.u * a.bz, by = a.by - p.v * a.bz;
        const Outline o{all(0.0f), all(0.0f), ax * ax + bx * bx + blur2, ax * ay + bx * by,
                        ay * ay + by * by + blur2};
        storeOutline(b, i, o, s);
        const FloatW narrow = larger(load<FloatW>(s.narrow + i), all(leastHalf));
        const FloatW inverseY = load<FloatW>(s.inverseY + i);
        const FloatW inverse = 1.0f / narrow;
        store(s.sx + i, inverse);
        store(s.sy + i, -(load<FloatW>(s.skew + i) * inverse));
        store(s.tx + i, all(0.0f));
        store(s.ty + i, inverseY);
        store(s.peak + i, smaller((absolute(ax * by - ay * bx) * inverse) * inverseY, all(1.0f)));

        const FloatW d = load<FloatW>(b.depth + i);
        const FloatW range = depthRange(a);
        const FloatW perM =
            (perspective ? all(1.0f) : -p.unitsPerPx) / (perspective ? p.m * pass.pixelsPerUnit : p.m);
        store(s.slopeX + i, p.x * perM);
        store(s.slopeY + i, p.y * perM);
        if constexpr (perspective) {
            store(s.low + i, 1.0f / (1.0f + range * pixel));
            store(s.high + i, all(1.0f));
        } else {
            store(s.low + i, d);
            store(s.high + i, d + range * p.unitsPerPx);
        }
        const FloatW tolerance = ellipseTolerance(pass, p, range);
        store(s.radius + i, p.half);
        store(s.tolerance + i, tolerance);
        storeFront(pass, d, all(0.0f), tolerance * p.unitsPerPx, i, s);
        store(s.reaches + i, p.drawn);
        storeCommon(pass, run, b, i, p, toleranceCode(tolerance) << 24, s);
        if (s.bends) storeBends(pass, run, b, first, i, p, load<FloatW>(s.peak + i), s);
    }
}

/// Those whose pixels touch the tile.
inline void collectSurfels(const Block& b, const KeyTile& tile, Surfels& s) {
    const std::int32_t right = tile.x + tile.width - 1, bottom = tile.y + tile.height - 1;
    for (int i = 0; i < b.padded; i += wideLanes) {
        const IntW reaches = (load<IntW>(s.x1 + i) >= tile.x) & (load<IntW>(s.x0 + i) <= right) &
                             (load<IntW>(s.y1 + i) >= tile.y) & (load<IntW>(s.y0 + i) <= bottom);
        store(s.reaches + i, load<IntW>(s.reaches + i) & reaches);
    }
    int n = 0;
    for (int i = 0; i < b.count; ++i) {
        s.list[n] = static_cast<std::uint16_t>(i);
        n -= s.reaches[i];
    }
    s.count = n;
}

}  // namespace
}  // namespace scancast::cpu
