#include "renderer/measure/robust.hpp"

namespace scancast {

std::vector<glm::dvec3> evenly(std::span<const glm::dvec3> points, std::size_t most) {
    const std::size_t count = std::min(points.size(), most);
    std::vector<glm::dvec3> some;
    some.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        some.push_back(points[std::size_t(double(i) * double(points.size()) / double(count))]);
    return some;
}

/// Cholesky, in place.
bool solve(std::span<double> matrix, std::span<double> right) {
    const std::size_t n = right.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = matrix[i * n + j];
            for (std::size_t k = 0; k < j; ++k) sum -= matrix[i * n + k] * matrix[j * n + k];
            if (i != j) {
                matrix[i * n + j] = sum / matrix[j * n + j];
                continue;
            }
            if (!(sum > 0) || !std::isfinite(sum)) return false;
            matrix[i * n + i] = std::sqrt(sum);
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < i; ++k) right[i] -= matrix[i * n + k] * right[k];
        right[i] /= matrix[i * n + i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) right[i] -= matrix[k * n + i] * right[k];
        right[i] /= matrix[i * n + i];
    }
    return true;
}

}  // namespace scancast
