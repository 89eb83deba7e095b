// Principal directions of eight neighbourhoods side by side, by Jacobi's rotations in double: no branch, no
// iteration count that depends on the data, so every SIMD level does the same. Included by
// surfel_kernels.cpp.
#pragma once

#include "renderer/cloud/surfel_kernels/surfel_kernels.hpp"

namespace scancast::surfel {
namespace {

using Lanes = double[chunk];

/// Symmetric matrices: xx, yy, zz, xy, xz, yz.
struct Matrices {
    Lanes m[6];
};
/// Columns of direction: v[3 * c + row].
struct Directions {
    Lanes v[9];
};

/// Zeroes element (p, q) of every matrix; `pr` and `qr` are the indices of the other two off the diagonal.
inline void rotate(Matrices& a, Directions& d, int p, int q, int pq, int pr, int qr) {
    for (int l = 0; l < chunk; ++l) {
        const double apq = a.m[pq][l];
        const double theta = (a.m[q][l] - a.m[p][l]) / (2 * apq);
        const double size = theta < 0 ? -theta : theta;
        const double tangent = 1 / (size + __builtin_sqrt(theta * theta + 1));
        double t = theta < 0 ? -tangent : tangent;
        t = apq == 0 ? 0 : t;
        const double c = 1 / __builtin_sqrt(t * t + 1), s = t * c;
        a.m[p][l] = a.m[p][l] - t * apq;
        a.m[q][l] = a.m[q][l] + t * apq;
        a.m[pq][l] = 0;
        const double apr = a.m[pr][l], aqr = a.m[qr][l];
        a.m[pr][l] = c * apr - s * aqr;
        a.m[qr][l] = s * apr + c * aqr;
        for (int row = 0; row < 3; ++row) {
            const double vp = d.v[3 * p + row][l], vq = d.v[3 * q + row][l];
            d.v[3 * p + row][l] = c * vp - s * vq;
            d.v[3 * q + row][l] = s * vp + c * vq;
        }
    }
}

/// Puts the larger variance first.
inline void order(Matrices& a, Directions& d, int p, int q) {
    for (int l = 0; l < chunk; ++l) {
        const bool swap = a.m[p][l] < a.m[q][l];
        const double ap = a.m[p][l], aq = a.m[q][l];
        a.m[p][l] = swap ? aq : ap;
        a.m[q][l] = swap ? ap : aq;
        for (int row = 0; row < 3; ++row) {
            const double vp = d.v[3 * p + row][l], vq = d.v[3 * q + row][l];
            d.v[3 * p + row][l] = swap ? vq : vp;
            d.v[3 * q + row][l] = swap ? vp : vq;
        }
    }
}

inline void principal(Matrices& a, Directions& d) {
    for (int i = 0; i < 9; ++i)
        for (int l = 0; l < chunk; ++l) d.v[i][l] = i % 4 == 0 ? 1 : 0;
    for (int sweep = 0; sweep < 5; ++sweep) {
        rotate(a, d, 0, 1, 3, 4, 5);
        rotate(a, d, 0, 2, 4, 3, 5);
        rotate(a, d, 1, 2, 5, 3, 4);
    }
    order(a, d, 0, 1);
    order(a, d, 0, 2);
    order(a, d, 1, 2);
}

/// Variances about the centroid of the first m neighbours and the point itself, lanes from `first` on.
inline void covariance(const Neighbourhoods& n, int first, int m, Matrices& a) {
    const double share = 1.0 / (m + 1);
    Lanes mean[3] = {};
    for (int j = 0; j < m; ++j)
        for (int l = 0; l < chunk; ++l) {
            mean[0][l] += n.x[j][first + l];
            mean[1][l] += n.y[j][first + l];
            mean[2][l] += n.z[j][first + l];
        }
    for (int l = 0; l < chunk; ++l) {
        const double x = mean[0][l] *= share, y = mean[1][l] *= share, z = mean[2][l] *= share;
        a.m[0][l] = x * x;
        a.m[1][l] = y * y;
        a.m[2][l] = z * z;
        a.m[3][l] = x * y;
        a.m[4][l] = x * z;
        a.m[5][l] = y * z;
    }
    for (int j = 0; j < m; ++j)
        for (int l = 0; l < chunk; ++l) {
            const double x = n.x[j][first + l] - mean[0][l], y = n.y[j][first + l] - mean[1][l],
                         z = n.z[j][first + l] - mean[2][l];
            a.m[0][l] += x * x;
            a.m[1][l] += y * y;
            a.m[2][l] += z * z;
            a.m[3][l] += x * y;
            a.m[4][l] += x * z;
            a.m[5][l] += y * z;
        }
    for (auto& e : a.m)
        for (int l = 0; l < chunk; ++l) e[l] *= share;
}

/// Average distance of the m neighbours.
inline void averageDistance(const Neighbourhoods& n, int first, int m, Lanes& out) {
    for (int l = 0; l < chunk; ++l) out[l] = 0;
    for (int j = 0; j < m; ++j)
        for (int l = 0; l < chunk; ++l) {
            const float x = n.x[j][first + l], y = n.y[j][first + l], z = n.z[j][first + l];
            out[l] += __builtin_sqrtf(x * x + y * y + z * z);
        }
    for (int l = 0; l < chunk; ++l) out[l] /= m;
}

}  // namespace
}  // namespace scancast::surfel
