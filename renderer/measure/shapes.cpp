#include "renderer/measure/shapes.hpp"

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace scancast {
namespace {

/// From the axis to the point, at right angles to it; and how far that is.
struct FromAxis {
    glm::dvec3 direction{0};
    double along = 0, distance = 0;

    FromAxis(const glm::dvec3& p, const glm::dvec3& center, const glm::dvec3& axis) {
        const glm::dvec3 q = p - center;
        along = glm::dot(q, axis);
        const glm::dvec3 radial = q - along * axis;
        distance = glm::length(radial);
        if (distance > 0) direction = radial / distance;
    }
};

}  // namespace

std::array<glm::dvec3, 2> across(const glm::dvec3& axis) {
    const glm::dvec3 other = std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 first = glm::normalize(glm::cross(axis, other));
    return {first, glm::cross(axis, first)};
}

std::optional<PlaneCircle> circleThrough(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const glm::dvec2 u = b - a, v = c - a;
    const double twice = 2 * (u.x * v.y - u.y * v.x), uu = glm::dot(u, u), vv = glm::dot(v, v);
    if (!(std::abs(twice) > 1e-12 * (uu + vv))) return std::nullopt;
    const glm::dvec2 from((uu * v.y - vv * u.y) / twice, (vv * u.x - uu * v.x) / twice);
    return PlaneCircle{a + from, glm::length(from)};
}

std::optional<FittedPlane> FittedPlane::through(std::span<const glm::dvec3> points) {
    const glm::dvec3 normal = glm::cross(points[1] - points[0], points[2] - points[0]);
    const double size = glm::length(normal);
    if (!(size > 0)) return std::nullopt;
    return FittedPlane{points[0], normal / size};
}

double FittedPlane::residual(const glm::dvec3& p, std::array<double, parameters>* slopes) const {
    const glm::dvec3 q = p - center;
    if (slopes != nullptr) {
        const auto [u, v] = across(normal);
        *slopes = {-1, glm::dot(q, u), glm::dot(q, v)};
    }
    return glm::dot(q, normal);
}

FittedPlane FittedPlane::moved(const std::array<double, parameters>& step) const {
    const auto [u, v] = across(normal);
    return {center + step[0] * normal, glm::normalize(normal + step[1] * u + step[2] * v)};
}

std::optional<FittedSphere> FittedSphere::through(std::span<const glm::dvec3> points) {
    // |p - c|² is the same for all: three linear equations.
    glm::dmat3 rows(0);
    glm::dvec3 right(0);
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 d = points[std::size_t(i) + 1] - points[0];
        rows[i] = d;  // a column: transposed below
        right[i] = glm::dot(d, d) / 2;
    }
    const glm::dmat3 matrix = glm::transpose(rows);
    const double size = glm::length(rows[0]) * glm::length(rows[1]) * glm::length(rows[2]);
    if (!(std::abs(glm::determinant(matrix)) > 1e-9 * size)) return std::nullopt;
    const glm::dvec3 from = glm::inverse(matrix) * right;
    return FittedSphere{points[0] + from, glm::length(from)};
}

double FittedSphere::residual(const glm::dvec3& p, std::array<double, parameters>* slopes) const {
    const glm::dvec3 q = p - center;
    const double distance = glm::length(q);
    if (slopes != nullptr) {
        const glm::dvec3 away = distance > 0 ? q / distance : glm::dvec3(0);
        *slopes = {-away.x, -away.y, -away.z, -1};
    }
    return distance - radius;
}

FittedSphere FittedSphere::moved(const std::array<double, parameters>& step) const {
    return {center + glm::dvec3(step[0], step[1], step[2]), radius + step[3]};
}

std::optional<FittedCircle> FittedCircle::through(std::span<const glm::dvec3> points,
                                                  const glm::dvec3& axis) {
    const auto [u, v] = across(axis);
    const auto flat = [&](const glm::dvec3& p) { return glm::dvec2(glm::dot(p, u), glm::dot(p, v)); };
    const auto circle = circleThrough(flat(points[0]), flat(points[1]), flat(points[2]));
    if (!circle) return std::nullopt;
    return FittedCircle{axis, circle->center.x * u + circle->center.y * v, circle->radius};
}

double FittedCircle::residual(const glm::dvec3& p, std::array<double, parameters>* slopes) const {
    const FromAxis from(p, center, axis);
    if (slopes != nullptr) {
        const auto [u, v] = across(axis);
        *slopes = {-glm::dot(from.direction, u), -glm::dot(from.direction, v), -1};
    }
    return from.distance - radius;
}

FittedCircle FittedCircle::moved(const std::array<double, parameters>& step) const {
    const auto [u, v] = across(axis);
    return {axis, center + step[0] * u + step[1] * v, radius + step[2]};
}

double FittedCylinder::residual(const glm::dvec3& p, std::array<double, parameters>* slopes) const {
    const FromAxis from(p, center, axis);
    if (slopes != nullptr) {
        const auto [u, v] = across(axis);
        const double alongU = glm::dot(from.direction, u), alongV = glm::dot(from.direction, v);
        *slopes = {-alongU, -alongV, -1, -from.along * alongU, -from.along * alongV};
    }
    return from.distance - radius;
}

FittedCylinder FittedCylinder::moved(const std::array<double, parameters>& step) const {
    const auto [u, v] = across(axis);
    return {glm::normalize(axis + step[3] * u + step[4] * v), center + step[0] * u + step[1] * v,
            radius + step[2]};
}

}  // namespace scancast
