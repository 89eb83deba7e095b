// Shapes that are fitted to points, each with how far a point is from it and how that changes when the shape does: what robust least
// squares need (fit.hpp). Plain values, pure functions. Points and shapes are near 0, in one unit on all axes.
#pragma once

#include <array>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

namespace scancast {

/// Two unit vectors at right angles to a unit vector and to each other.
std::array<glm::dvec3, 2> across(const glm::dvec3& axis);

/// The circle through three points of a plane; nullopt where they are on a line.
struct PlaneCircle {
    glm::dvec2 center{0};
    double radius = 0;
};
std::optional<PlaneCircle> circleThrough(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c);

/// Each: Parameters numbers; residual() - signed distance of a point, with its derivatives by these -; moved() by a step of them;
/// through() the fewest points that tell one, `points` many.
struct FittedPlane {
    static constexpr std::size_t parameters = 3, points = 3;
    glm::dvec3 center{0}, normal{0, 0, 1};

    static std::optional<FittedPlane> through(std::span<const glm::dvec3> points);
    double residual(const glm::dvec3& p, std::array<double, parameters>* slopes = nullptr) const;
    FittedPlane moved(const std::array<double, parameters>& step) const;
};

struct FittedSphere {
    static constexpr std::size_t parameters = 4, points = 4;
    glm::dvec3 center{0};
    double radius = 0;

    static std::optional<FittedSphere> through(std::span<const glm::dvec3> points);
    double residual(const glm::dvec3& p, std::array<double, parameters>* slopes = nullptr) const;
    FittedSphere moved(const std::array<double, parameters>& step) const;
};

/// A circle seen along its axis: of points, where they are along it has no part in it.
struct FittedCircle {
    static constexpr std::size_t parameters = 3, points = 3;
    glm::dvec3 axis{0, 0, 1}, center{0};  ///< the center's place along the axis is any
    double radius = 0;

    static std::optional<FittedCircle> through(std::span<const glm::dvec3> points, const glm::dvec3& axis);
    double residual(const glm::dvec3& p, std::array<double, parameters>* slopes = nullptr) const;
    FittedCircle moved(const std::array<double, parameters>& step) const;
};

/// The same, whose axis is to be found, too.
struct FittedCylinder {
    static constexpr std::size_t parameters = 5;
    glm::dvec3 axis{0, 0, 1}, center{0};
    double radius = 0;

    double residual(const glm::dvec3& p, std::array<double, parameters>* slopes = nullptr) const;
    FittedCylinder moved(const std::array<double, parameters>& step) const;
};

}  // namespace scancast
