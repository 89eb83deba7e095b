// Where discs meet at an angle: which of two is the surface, and which only hangs over it. docs/spec/voronoi.md §4. Part of
// kernels.cpp.
//
// Frame: view space, x right, y up, z towards the viewer; lengths are px at the visible depth. The ray through a pixel
// is ρ = (u, v, -1) in perspective, (0, 0, -1) without; normals point to the eye, so that n · ρ < 0.
#pragma once

#include "renderer/device/cpu/kernels/formulas.hpp"

namespace scancast::cpu {
namespace {

/// A visible normal, out of its bytes.
template <int lanes>
struct Unpacked {
    Float<lanes> x, y, z;

    explicit Unpacked(Int<lanes> bytes) {
        const auto part = [](Int<lanes> top) {
            return __builtin_convertvector(top >> 24, Float<lanes>) * stepPerNormal;
        };
        x = part(bytes << 24);
        y = part(bytes << 16);
        z = part(bytes << 8);
    }
};

/// A disc at one pixel: its normal, the way to its centre in the picture, and half of its size.
template <int lanes>
struct DiscThere {
    float x, y, z;
    Float<lanes> right, up;
    float half;
};

/// What becomes of a disc that lies behind a visible one of another direction: each lane 0 or -1.
template <int lanes>
struct Verdict {
    Int<lanes> wins;     ///< the surface is its: the visible one hangs over a convex crease
    Int<lanes> shunned;  ///< it is not: it goes on behind a concave one
};

/// `gap`: px along the ray (u, v, -1) from the visible one to the disc.
template <int lanes>
inline Verdict<lanes> meet(Int<lanes> visible, const DiscThere<lanes>& disc, Float<lanes> gap, Float<lanes> u,
                           Float<lanes> v) {
    using F = Float<lanes>;
    const Unpacked<lanes> n(visible);
    const F pxPerStep = F{} + disc.half * halfPerStep;
    const F right = __builtin_convertvector((visible << 4) >> 28, F) * pxPerStep;
    const F up = __builtin_convertvector(visible >> 28, F) * pxPerStep;
    const F most = F{} - leastOpen;
    const F there = (n.x * u + n.y * v) - n.z, own = (disc.x * u + disc.y * v) - disc.z;
    const F n0 = there < most ? there : most, d0 = own < most ? own : most;
    const F along = (n.x * right + n.y * up) / n0, back = (disc.x * disc.right + disc.y * disc.up) / d0;
    // The visible one's centre over the disc's plane, and the disc's centre over that of the visible one.
    const F above = (disc.x * right + disc.y * up) - (along + gap) * d0;
    const F itself = (n.x * disc.right + n.y * disc.up) + (gap - back) * n0;
    const F limit = F{} + creaseSlack * disc.half;
    const Int<lanes> wins = (above <= limit) & (itself <= limit) & (above + itself < 0.0f);
    const Int<lanes> crossing = (above < -limit) & (itself > limit);
    return {wins, ~(wins | crossing)};
}

}  // namespace
}  // namespace scancast::cpu
