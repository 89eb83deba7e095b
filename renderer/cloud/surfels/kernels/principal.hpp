// Principal directions of several neighbourhoods side by side, by Jacobi's rotations in double: no branch and
// no number of rounds that depends on the data, so every SIMD level does the same. Included by
// surfel_kernels.cpp only.
#pragma once

#include <immintrin.h>

#include "renderer/cloud/surfels/kernels/surfel_kernels.hpp"

namespace scancast::surfel {
namespace {

// As wide as a level's registers: of wider vectors the compiler compares, chooses and takes roots element by element.
#if SCANCAST_SIMD_LEVEL >= 3
constexpr int partLanes = 4;
#else
constexpr int partLanes = 2;
#endif
typedef double Part __attribute__((vector_size(partLanes * sizeof(double))));
typedef float FloatPart __attribute__((vector_size(partLanes * sizeof(float))));

/// Two registers at once: a rotation is a chain of roots and divisions, each of which waits for the one before.
struct Lanes {
    Part low, high;
    double operator[](int l) const { return reinterpret_cast<const double*>(this)[l]; }
};
constexpr int chunk = 2 * partLanes;  ///< lanes that are solved side by side
static_assert(batchLanes % chunk == 0);

inline Lanes operator+(const Lanes& a, const Lanes& b) {
    return {a.low + b.low, a.high + b.high};
}
inline Lanes operator-(const Lanes& a, const Lanes& b) {
    return {a.low - b.low, a.high - b.high};
}
inline Lanes operator*(const Lanes& a, const Lanes& b) {
    return {a.low * b.low, a.high * b.high};
}
inline Lanes operator/(const Lanes& a, const Lanes& b) {
    return {a.low / b.low, a.high / b.high};
}
inline Lanes all(double v) {
    return {Part{} + v, Part{} + v};
}

inline Part rootOf(const Part& v) {
#if SCANCAST_SIMD_LEVEL >= 3
    return Part(_mm256_sqrt_pd(__m256d(v)));
#else
    return Part(_mm_sqrt_pd(__m128d(v)));
#endif
}
inline Lanes rootOf(const Lanes& v) {
    return {rootOf(v.low), rootOf(v.high)};
}
inline FloatPart rootOf(const FloatPart& v) {
#if SCANCAST_SIMD_LEVEL >= 3
    return FloatPart(_mm_sqrt_ps(__m128(v)));
#else
    return FloatPart{__builtin_sqrtf(v[0]), __builtin_sqrtf(v[1])};
#endif
}

/// `sign` < 0 ? -v : v
inline Lanes turnedBy(const Lanes& sign, const Lanes& v) {
    return {sign.low < 0 ? -v.low : v.low, sign.high < 0 ? -v.high : v.high};
}

inline void load(const float* from, FloatPart& to) {
    __builtin_memcpy(&to, from, sizeof to);
}

inline void load(const float* from, Part& to) {
    FloatPart v;
    load(from, v);
    to = __builtin_convertvector(v, Part);
}

/// Symmetric matrices.
struct Matrices {
    Lanes diagonal[3];
    Lanes xy, xz, yz;
    Lanes mean[3];  ///< of the neighbours and the point itself, from the point
};
struct Directions {
    Lanes axis[3][3];  ///< first, second, third direction; x, y, z
};

/// Zeroes pq, the element that joins directions p and q; pr and qr join them with the third.
inline void rotate(Lanes& p, Lanes& q, Lanes& pq, Lanes& pr, Lanes& qr, Lanes (&dp)[3], Lanes (&dq)[3]) {
    const Lanes apart = q - p, twice = pq + pq;
    const Lanes below = rootOf(apart * apart + twice * twice) + turnedBy(apart, apart);
    Lanes t = turnedBy(apart, twice) / below;
    t = {below.low > 0 ? t.low : Part{}, below.high > 0 ? t.high : Part{}};
    const Lanes c = all(1) / rootOf(t * t + all(1));
    const Lanes s = t * c;
    p = p - t * pq;
    q = q + t * pq;
    pq = all(0);
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
inline void order(Part& p, Part& q, Part* const (&dp)[3], Part* const (&dq)[3]) {
    const auto swap = p < q;
    const Part old = p;
    p = swap ? q : p;
    q = swap ? old : q;
    for (int row = 0; row < 3; ++row) {
        const Part before = *dp[row];
        *dp[row] = swap ? *dq[row] : before;
        *dq[row] = swap ? before : *dq[row];
    }
}
inline void order(Lanes& p, Lanes& q, Lanes (&dp)[3], Lanes (&dq)[3]) {
    order(p.low, q.low, {&dp[0].low, &dp[1].low, &dp[2].low}, {&dq[0].low, &dq[1].low, &dq[2].low});
    order(p.high, q.high, {&dp[0].high, &dp[1].high, &dp[2].high}, {&dq[0].high, &dq[1].high, &dq[2].high});
}

/// The variances, descending, are left in the diagonal.
inline void principal(Matrices& a, Directions& d) {
    for (int i = 0; i < 3; ++i)
        for (int row = 0; row < 3; ++row) d.axis[i][row] = all(i == row ? 1.0 : 0.0);
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

/// Of one register's lanes: variances and the mean.
struct PartMoments {
    Part xx, yy, zz, xy, xz, yz, mx, my, mz;
};

/// About the centroid of the first m neighbours and the point itself, lanes from `first` on.
inline void momentsOf(const Neighbourhoods& n, int first, int m, PartMoments& out) {
    const double share = 1.0 / (m + 1);
    Part mx{}, my{}, mz{};
    for (int j = 0; j < m; ++j) {
        Part x, y, z;
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
    Part xx = mx * mx, yy = my * my, zz = mz * mz, xy = mx * my, xz = mx * mz, yz = my * mz;
    for (int j = 0; j < m; ++j) {
        Part x, y, z;
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
    out = {xx * share, yy * share, zz * share, xy * share, xz * share, yz * share, mx, my, mz};
}

inline void covariance(const Neighbourhoods& n, int first, int m, Matrices& a) {
    PartMoments low, high;
    momentsOf(n, first, m, low);
    momentsOf(n, first + partLanes, m, high);
    a = {{{low.xx, high.xx}, {low.yy, high.yy}, {low.zz, high.zz}},
         {low.xy, high.xy},
         {low.xz, high.xz},
         {low.yz, high.yz},
         {{low.mx, high.mx}, {low.my, high.my}, {low.mz, high.mz}}};
}

/// Average distances of the m neighbours, and of the first few of them.
inline void averageDistances(const Neighbourhoods& n, int first, int m, int few, Part& ofAll, Part& ofFew) {
    Part sum{};
    ofFew = Part{};
    for (int j = 0; j < m; ++j) {
        FloatPart x, y, z;
        load(&n.x[j][first], x);
        load(&n.y[j][first], y);
        load(&n.z[j][first], z);
        sum += __builtin_convertvector(rootOf(x * x + y * y + z * z), Part);
        if (j + 1 == few) ofFew = sum / double(few);
    }
    ofAll = sum / double(m);
}

}  // namespace
}  // namespace scancast::surfel
