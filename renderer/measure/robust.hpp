// Least squares that outliers do not bend: a start by the least median of squares, then Levenberg and Marquardt's steps with Tukey's
// biweight, whose scale the residuals tell. Deterministic. Pure functions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace scancast {

/// From a residual's median size to a standard deviation, of what is distributed normally; and Tukey's width in those.
inline constexpr double medianToDeviation = 1.4826, tukeyWidth = 4.685;

/// Numbers that look random, the same every time.
class Lots {
  public:
    /// Below `bound`, which is > 0.
    std::size_t below(std::size_t bound) {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return std::size_t((state_ >> 33) % bound);
    }

  private:
    std::uint64_t state_ = 0x9e3779b97f4a7c15ULL;
};

/// At most so many, evenly out of all.
std::vector<glm::dvec3> evenly(std::span<const glm::dvec3> points, std::size_t most);

template <class Shape>
double medianResidual(const Shape& shape, std::span<const glm::dvec3> points, std::vector<double>& room) {
    room.clear();
    for (const glm::dvec3& p : points) room.push_back(std::abs(shape.residual(p)));
    const auto middle = room.begin() + std::ptrdiff_t(room.size() / 2);
    std::nth_element(room.begin(), middle, room.end());
    return *middle;
}

/// Of `tries` shapes through `fewest` points each, the one with the least median; `make`: points → shape, or nullopt.
template <class Shape, class Make>
std::optional<Shape> leastMedian(std::span<const glm::dvec3> points, std::size_t fewest, int tries, Make make,
                                 double& least) {
    std::optional<Shape> best;
    if (points.size() < fewest) return best;
    Lots lots;
    std::vector<glm::dvec3> few(fewest);
    std::vector<double> room;
    for (int i = 0; i < tries; ++i) {
        for (glm::dvec3& p : few) p = points[lots.below(points.size())];
        const std::optional<Shape> shape = make(std::span<const glm::dvec3>(few));
        if (!shape) continue;
        const double median = medianResidual(*shape, points, room);
        if (best && !(median < least)) continue;
        best = shape;
        least = median;
    }
    return best;
}

/// Solves a symmetric, positive system; false where it is none.
bool solve(std::span<double> matrix, std::span<double> right);

/// 1 at 0, 0 from the width on.
inline double tukeyWeight(double residual, double width) {
    const double x = width > 0 ? residual / width : residual == 0 ? 0 : 1;
    return std::abs(x) >= 1 ? 0 : (1 - x * x) * (1 - x * x);
}

template <class Shape>
struct RobustFit {
    Shape shape;
    double width = 0;  ///< points that are farther off have no weight
    double rms = 0;    ///< of the residuals of those that are not
    std::uint64_t used = 0;

    bool uses(const glm::dvec3& p) const { return std::abs(shape.residual(p)) <= width; }
};

/// From a shape that is near. `finest`: how finely coordinates are told apart; residuals are not believed to be less.
template <class Shape>
RobustFit<Shape> refine(Shape shape, std::span<const glm::dvec3> points, double finest, int rounds) {
    constexpr std::size_t n = Shape::parameters;
    std::vector<double> room;
    double width = 0, damping = 1e-6;
    for (int round = 0; round < rounds; ++round) {
        width = tukeyWidth * std::max(finest, medianToDeviation * medianResidual(shape, points, room));
        std::array<double, n * n> normal{};
        std::array<double, n> right{}, slopes{};
        double before = 0;
        for (const glm::dvec3& p : points) {
            const double residual = shape.residual(p, &slopes), weight = tukeyWeight(residual, width);
            if (weight == 0) continue;
            before += weight * residual * residual;
            for (std::size_t i = 0; i < n; ++i) {
                right[i] -= weight * slopes[i] * residual;
                for (std::size_t j = 0; j < n; ++j) normal[i * n + j] += weight * slopes[i] * slopes[j];
            }
        }
        for (std::size_t i = 0; i < n; ++i) normal[i * n + i] *= 1 + damping;
        std::array<double, n> step = right;
        if (!solve(normal, step)) break;
        const Shape next = shape.moved(step);
        double after = 0;
        for (const glm::dvec3& p : points) {
            const double residual = next.residual(p);
            // The weights of before: what they weigh is what this step was to lessen.
            const double weight = tukeyWeight(shape.residual(p), width);
            if (weight > 0) after += weight * residual * residual;
        }
        if (!(after <= before)) {
            damping = std::max(1e-3, damping * 10);
            if (damping > 1e9) break;
            continue;
        }
        damping = std::max(1e-9, damping / 10);
        shape = next;
        if (before - after <= 1e-12 * before && round > 4) break;
    }
    RobustFit<Shape> fit{shape, width, 0, 0};
    double sum = 0;
    for (const glm::dvec3& p : points) {
        if (!fit.uses(p)) continue;
        const double residual = shape.residual(p);
        sum += residual * residual;
        ++fit.used;
    }
    if (fit.used > 0) fit.rms = std::sqrt(sum / double(fit.used));
    return fit;
}

}  // namespace scancast
