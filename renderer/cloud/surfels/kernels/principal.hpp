// Principal directions of eight neighbourhoods side by side, by Jacobi's rotations in double: no branch and
// no number of rounds that depends on the data, so every SIMD level does the same. Included by
// surfel_kernels.cpp only.
#pragma once

#include "renderer/cloud/surfels/kernels/surfel_kernels.hpp"

namespace scancast::surfel {
namespace {

// The compiler splits these into registers of whatever width a level has.
typedef double Lanes __attribute__((vector_size(chunk * sizeof(double))));
typedef float FloatLanes __attribute__((vector_size(chunk * sizeof(float))));

/// Symmetric matrices.
struct Matrices {
    Lanes diagonal[3];
    Lanes xy, xz, yz;
    Lanes mean[3];  ///< of the neighbours and the point itself, from the point
};
struct Directions {
    Lanes axis[3][3];  ///< first, second, third direction; x, y, z
};

// Results go through references: returning a wide vector is another calling convention on every level.
template <class V>
inline void takeRoot(V& v) {
    for (int l = 0; l < chunk; ++l) v[l] = sizeof v[l] == 8 ? __builtin_sqrt(v[l]) : __builtin_sqrtf(v[l]);
}

inline void load(const float* from, FloatLanes& to) {
    __builtin_memcpy(&to, from, sizeof to);
}

inline void load(const float* from, Lanes& to) {
    FloatLanes v;
    load(from, v);
    to = __builtin_convertvector(v, Lanes);
}

/// Zeroes pq, the element that joins directions p and q; pr and qr join them with the third.
inline void rotate(Lanes& p, Lanes& q, Lanes& pq, Lanes& pr, Lanes& qr, Lanes (&dp)[3], Lanes (&dq)[3]) {
    const Lanes apart = q - p, twice = pq + pq;
    const Lanes size = apart < 0 ? -apart : apart;
    Lanes below = apart * apart + twice * twice;
    takeRoot(below);
    below += size;
    Lanes t = (apart < 0 ? -twice : twice) / below;
    t = below > 0 ? t : Lanes{};
    Lanes c = t * t + 1;
    takeRoot(c);
    c = 1 / c;
    const Lanes s = t * c;
    p -= t * pq;
    q += t * pq;
    pq = Lanes{};
    const Lanes oldPr = pr;
    pr = c * pr - s * qr;
    qr = s * oldPr + c * qr;
    for (int row = 0; row < 3; ++row) {
        const Lanes old = dp[row];
        dp[row] = c * old - s * dq[row];
        dq[row] = s * old + c * dq[row];
    }
}

/// Puts the larger variance first.
inline void order(Lanes& p, Lanes& q, Lanes (&dp)[3], Lanes (&dq)[3]) {
    const auto swap = p < q;
    const Lanes old = p;
    p = swap ? q : p;
    q = swap ? old : q;
    for (int row = 0; row < 3; ++row) {
        const Lanes before = dp[row];
        dp[row] = swap ? dq[row] : before;
        dq[row] = swap ? before : dq[row];
    }
}

/// The variances, descending, are left in the diagonal.
inline void principal(Matrices& a, Directions& d) {
    for (int i = 0; i < 3; ++i)
        for (int row = 0; row < 3; ++row) d.axis[i][row] = Lanes{} + (i == row ? 1.0 : 0.0);
    Lanes(&v)[3] = a.diagonal;
    for (int sweep = 0; sweep < 4; ++sweep) {
        rotate(v[0], v[1], a.xy, a.xz, a.yz, d.axis[0], d.axis[1]);
        rotate(v[0], v[2], a.xz, a.xy, a.yz, d.axis[0], d.axis[2]);
        rotate(v[1], v[2], a.yz, a.xy, a.xz, d.axis[1], d.axis[2]);
    }
    order(v[0], v[1], d.axis[0], d.axis[1]);
    order(v[0], v[2], d.axis[0], d.axis[2]);
    order(v[1], v[2], d.axis[1], d.axis[2]);
}

/// Variances about the centroid of the first m neighbours and the point itself, lanes from `first` on.
inline void covariance(const Neighbourhoods& n, int first, int m, Matrices& a) {
    const double share = 1.0 / (m + 1);
    Lanes mx{}, my{}, mz{};
    for (int j = 0; j < m; ++j) {
        Lanes x, y, z;
        load(&n.x[j][first], x);
        load(&n.y[j][first], y);
        load(&n.z[j][first], z);
        mx += x;
        my += y;
        mz += z;
    }
    mx *= share;
    my *= share;
    mz *= share;
    Lanes xx = mx * mx, yy = my * my, zz = mz * mz, xy = mx * my, xz = mx * mz, yz = my * mz;
    for (int j = 0; j < m; ++j) {
        Lanes x, y, z;
        load(&n.x[j][first], x);
        load(&n.y[j][first], y);
        load(&n.z[j][first], z);
        x -= mx;
        y -= my;
        z -= mz;
        xx += x * x;
        yy += y * y;
        zz += z * z;
        xy += x * y;
        xz += x * z;
        yz += y * z;
    }
    a = {{xx * share, yy * share, zz * share}, xy * share, xz * share, yz * share, {mx, my, mz}};
}

/// Average distance of the m neighbours.
inline void averageDistance(const Neighbourhoods& n, int first, int m, Lanes& average) {
    average = Lanes{};
    for (int j = 0; j < m; ++j) {
        FloatLanes x, y, z;
        load(&n.x[j][first], x);
        load(&n.y[j][first], y);
        load(&n.z[j][first], z);
        x = x * x + y * y + z * z;
        takeRoot(x);
        average += __builtin_convertvector(x, Lanes);
    }
    average /= double(m);
}

}  // namespace
}  // namespace scancast::surfel
