#include "renderer/cloud/build/nodes/tangent_plane.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>

namespace scancast {

namespace {

/// One Jacobi rotation that zeroes m[p][q]; v collects the directions in its columns.
void rotate(glm::dmat3& m, glm::dmat3& v, int p, int q) {
    if (m[p][q] == 0) return;
    const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    const double t = (theta >= 0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; ++k) {
        const double mkp = m[k][p], mkq = m[k][q];
        m[k][p] = c * mkp - s * mkq;
        m[k][q] = s * mkp + c * mkq;
    }
    for (int k = 0; k < 3; ++k) {
        const double mpk = m[p][k], mqk = m[q][k];
        m[p][k] = c * mpk - s * mqk;
        m[q][k] = s * mpk + c * mqk;
    }
    const glm::dvec3 vp = v[p], vq = v[q];
    v[p] = c * vp - s * vq;
    v[q] = s * vp + c * vq;
}

}  // namespace

TangentPlane tangentPlane(std::span<const glm::vec3> offsets) {
    // Scaled so that neither very small nor very large clouds leave the range of squares.
    double scale = 0;
    for (const glm::vec3& o : offsets)
        scale = std::max({scale, std::abs(double(o.x)), std::abs(double(o.y)), std::abs(double(o.z))});
    TangentPlane plane;
    if (!(scale > 0)) return plane;
    glm::dvec3 sum(0);
    glm::dmat3 m(0);
    for (const glm::vec3& offset : offsets) {
        const glm::dvec3 o = glm::dvec3(offset) / scale;
        sum += o;
        for (int a = 0; a < 3; ++a) m[a] += o * o[a];
    }
    const double n = double(offsets.size() + 1);
    for (int a = 0; a < 3; ++a) m[a] = m[a] / n - (sum / n) * (sum[a] / n);

    glm::dmat3 v(1);
    for (int sweep = 0; sweep < 8; ++sweep) {
        rotate(m, v, 0, 1);
        rotate(m, v, 0, 2);
        rotate(m, v, 1, 2);
    }
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return m[a][a] > m[b][b]; });
    plane.first = glm::normalize(v[order[0]]);
    plane.second = glm::normalize(v[order[1]]);
    for (int i = 0; i < 3; ++i) plane.variance[i] = m[order[i]][order[i]] * scale * scale;
    return plane;
}

}  // namespace scancast
