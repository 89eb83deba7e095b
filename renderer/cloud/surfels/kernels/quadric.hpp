// The quadric that eight neighbourhoods lie nearest to, side by side, in double: how the surface bends. Included by
// surfel_kernels.cpp only. Source: docs/spec/surfels.md §11.
#pragma once

#include "renderer/cloud/surfels/kernels/principal.hpp"

namespace scancast::surfel {
namespace {

/// Constants, slopes, then second derivatives: 1, u, v, u²/2, u·v, v²/2.
inline constexpr int quadricTerms = 6, planeTerms = 3;
/// Of F(3, 5), what a plane's noise exceeds once in a thousand: what bends less than that is flat.
inline constexpr double bendsBeyondNoise = 33.2;
/// Of a pivot, in units of the reach: less, and the neighbours lie on two lines, and say nothing of what is between.
inline constexpr double leastPivot = 1e-4;

/// Moments of the neighbours and the point itself: m[i][j] = Σ uⁱ vʲ, h[i][j] = Σ h uⁱ vʲ; u, v along the first two
/// directions and h along the third, in units of the reach.
struct QuadricMoments {
    Lanes m[5][5], h[3][3], hh;
};

inline void addMoments(const Lanes& u, const Lanes& v, const Lanes& h, QuadricMoments& s) {
    const Lanes uu = u * u, uv = u * v, vv = v * v;
    s.m[1][0] += u;
    s.m[0][1] += v;
    s.m[2][0] += uu;
    s.m[1][1] += uv;
    s.m[0][2] += vv;
    s.m[3][0] += uu * u;
    s.m[2][1] += uu * v;
    s.m[1][2] += u * vv;
    s.m[0][3] += vv * v;
    s.m[4][0] += uu * uu;
    s.m[3][1] += uu * uv;
    s.m[2][2] += uv * uv;
    s.m[1][3] += uv * vv;
    s.m[0][4] += vv * vv;
    s.h[0][0] += h;
    s.h[1][0] += h * u;
    s.h[0][1] += h * v;
    s.h[2][0] += h * uu;
    s.h[1][1] += h * uv;
    s.h[0][2] += h * vv;
    s.hh += h * h;
}

/// Second derivatives of h: along u, mixed, along v, over the cloud's units; 0 where noise explains them. Of the first m
/// neighbours and the point itself, lanes from `first` on, in the principal directions.
inline void fitQuadric(const Neighbourhoods& n, int first, int m, const Directions& d, Lanes (&bend)[3]) {
    for (Lanes& b : bend) b = Lanes{};
    if (m + 1 <= quadricTerms) return;
    Lanes reach;
    load(&n.reach2[first], reach);
    takeRoot(reach);
    const Lanes unit = reach > 0 ? 1 / reach : Lanes{};
    QuadricMoments s{};
    s.m[0][0] = Lanes{} + double(m + 1);
    for (int j = 0; j < m; ++j) {
        Lanes x, y, z;
        load(&n.x[j][first], x);
        load(&n.y[j][first], y);
        load(&n.z[j][first], z);
        x *= unit;
        y *= unit;
        z *= unit;
        addMoments(d.axis[0][0] * x + d.axis[0][1] * y + d.axis[0][2] * z,
                   d.axis[1][0] * x + d.axis[1][1] * y + d.axis[1][2] * z,
                   d.axis[2][0] * x + d.axis[2][1] * y + d.axis[2][2] * z, s);
    }
    // Normal equations a · x = y, factored a = L D Lᵀ; what each term explains of h is y²/D.
    constexpr int powerU[quadricTerms] = {0, 1, 0, 2, 1, 0}, powerV[quadricTerms] = {0, 0, 1, 0, 1, 2};
    constexpr double share[quadricTerms] = {1, 1, 1, 0.5, 1, 0.5};
    Lanes a[quadricTerms][quadricTerms], y[quadricTerms], pivot[quadricTerms];
    for (int i = 0; i < quadricTerms; ++i) {
        y[i] = share[i] * s.h[powerU[i]][powerV[i]];
        for (int j = 0; j <= i; ++j)
            a[i][j] = (share[i] * share[j]) * s.m[powerU[i] + powerU[j]][powerV[i] + powerV[j]];
    }
    Lanes left = s.hh, leftOfPlane = s.hh;
    auto sound = reach > 0;
    for (int i = 0; i < quadricTerms; ++i) {
        pivot[i] = a[i][i];
        sound &= pivot[i] > leastPivot;
        const Lanes inverse = 1 / (pivot[i] > leastPivot ? pivot[i] : Lanes{} + 1.0);
        left -= y[i] * y[i] * inverse;
        if (i < planeTerms) leftOfPlane = left;
        for (int r = i + 1; r < quadricTerms; ++r) {
            const Lanes factor = a[r][i] * inverse;
            for (int c = i + 1; c <= r; ++c) a[r][c] -= factor * a[c][i];
            y[r] -= factor * y[i];
        }
        pivot[i] = inverse;
    }
    // Column i below the diagonal still holds L's times the pivot: what back substitution needs.
    const Lanes along = y[5] * pivot[5];
    const Lanes mixed = (y[4] - a[5][4] * along) * pivot[4];
    const Lanes across = (y[3] - a[5][3] * along - a[4][3] * mixed) * pivot[3];
    left = left > 0 ? left : Lanes{};
    const double freedom = m + 1 - quadricTerms, terms = quadricTerms - planeTerms;
    sound &= (leftOfPlane - left) * freedom > (bendsBeyondNoise * terms) * left;
    bend[0] = sound ? across * unit : Lanes{};
    bend[1] = sound ? mixed * unit : Lanes{};
    bend[2] = sound ? along * unit : Lanes{};
}

}  // namespace
}  // namespace scancast::surfel
