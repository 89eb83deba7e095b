#include "protocol/measure/principal_axes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

namespace scancast {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

/// One Jacobi rotation, which makes m[p][q] zero; columns of v follow.
void rotate(Matrix& m, Matrix& v, std::size_t p, std::size_t q) {
    if (m[p][q] == 0) return;
    const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    for (std::size_t k = 0; k < 3; ++k) {
        const double kp = m[k][p], kq = m[k][q];
        m[k][p] = c * kp - s * kq;
        m[k][q] = s * kp + c * kq;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const double pk = m[p][k], qk = m[q][k];
        m[p][k] = c * pk - s * qk;
        m[q][k] = s * pk + c * qk;
        const double vp = v[k][p], vq = v[k][q];
        v[k][p] = c * vp - s * vq;
        v[k][q] = s * vp + c * vq;
    }
}

}  // namespace

PrincipalAxes principalAxes(std::span<const glm::dvec3> points, std::span<const double> weights) {
    PrincipalAxes result;
    double sum = 0;
    const glm::dvec3 start = points.front();  // coordinates may be large, and close to each other
    glm::dvec3 mean(0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double w = weights.empty() ? 1 : weights[i];
        sum += w;
        mean += w * (points[i] - start);
    }
    mean /= sum;
    Matrix m{}, v{};
    for (std::size_t a = 0; a < 3; ++a) v[a][a] = 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double w = (weights.empty() ? 1 : weights[i]) / sum;
        const glm::dvec3 d = points[i] - start - mean;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) m[std::size_t(a)][std::size_t(b)] += w * d[a] * d[b];
    }
    for (int sweep = 0; sweep < 16; ++sweep) {
        rotate(m, v, 0, 1);
        rotate(m, v, 0, 2);
        rotate(m, v, 1, 2);
    }
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return m[a][a] < m[b][b]; });
    result.center = start + mean;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t from = order[a];
        result.axes[a] = glm::normalize(glm::dvec3(v[0][from], v[1][from], v[2][from]));
        result.variances[a] = std::max(0.0, m[from][from]);
    }
    result.axes[2] = glm::cross(result.axes[0], result.axes[1]);
    return result;
}

}  // namespace scancast
