#include "protocol/measure/vertices.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "protocol/measure/principal_axes.hpp"

namespace scancast {
namespace {

/// Relative to the first vertex, heights in the unit of x and y.
std::vector<glm::dvec3> inOneUnit(std::span<const glm::dvec3> vertices, double heightScale) {
    std::vector<glm::dvec3> all;
    all.reserve(vertices.size());
    for (const glm::dvec3& vertex : vertices)
        all.push_back((vertex - vertices.front()) * glm::dvec3(1, 1, heightScale));
    return all;
}

std::optional<double> degreesBetween(const glm::dvec3& a, const glm::dvec3& b) {
    if (glm::length(a) == 0 || glm::length(b) == 0) return std::nullopt;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool isBetween(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
           p.y <= std::max(a.y, b.y);
}

bool meet(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
    if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0)))
        return true;
    return (abc == 0 && isBetween(a, b, c)) || (abd == 0 && isBetween(a, b, d)) ||
           (cda == 0 && isBetween(c, d, a)) || (cdb == 0 && isBetween(c, d, b));
}

}  // namespace

PolylineMeasure measurePolyline(std::span<const glm::dvec3> vertices, double heightScale) {
    PolylineMeasure all;
    for (std::size_t i = 1; i < vertices.size(); ++i) {
        const glm::dvec3 d = vertices[i] - vertices[i - 1];
        const double horizontal = std::hypot(d.x, d.y);
        all.legs.push_back({std::hypot(horizontal, d.z * heightScale), horizontal, d.z});
        all.length += all.legs.back().length;
        all.horizontal += horizontal;
        (d.z > 0 ? all.climb : all.descent) += std::abs(d.z);
    }
    all.vertical = vertices.back().z - vertices.front().z;
    return all;
}

std::vector<VertexAngle> measureAngles(std::span<const glm::dvec3> vertices, double heightScale) {
    const auto points = inOneUnit(vertices, heightScale);
    std::vector<VertexAngle> angles;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        const glm::dvec3 back = points[i - 1] - points[i], on = points[i + 1] - points[i];
        const glm::dvec3 flat(1, 1, 0);
        angles.push_back({degreesBetween(back, on), degreesBetween(back * flat, on * flat)});
    }
    return angles;
}

double signedArea(std::span<const glm::dvec2> corners) {
    double twice = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec2 a = corners[i] - corners[0], b = corners[(i + 1) % corners.size()] - corners[0];
        twice += a.x * b.y - a.y * b.x;
    }
    return twice / 2;
}

std::optional<std::array<std::size_t, 2>> crossingEdges(std::span<const glm::dvec2> corners) {
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 2; j < n; ++j) {
            if (i == 0 && j == n - 1) continue;  // neighbours
            if (meet(corners[i], corners[i + 1], corners[j], corners[(j + 1) % n])) return {{i, j}};
        }
    return std::nullopt;
}

glm::dvec3 upwards(const glm::dvec3& normal) {
    constexpr double flat = 1e-9;
    const double side = std::abs(normal.z) > flat   ? normal.z
                        : std::abs(normal.x) > flat ? normal.x
                                                    : normal.y;
    return side < 0 ? -normal : normal;
}

AreaMeasure measureArea(std::span<const glm::dvec3> corners, double heightScale) {
    const auto points = inOneUnit(corners, heightScale);
    const PrincipalAxes axes = principalAxes(points);
    AreaMeasure all;
    std::vector<glm::dvec2> inPlan, inPlane;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 p = points[i], d = points[(i + 1) % points.size()] - p;
        all.perimeter += glm::length(d);
        all.planPerimeter += std::hypot(d.x, d.y);
        inPlan.emplace_back(p.x, p.y);
        inPlane.emplace_back(glm::dot(axes.axes[1], p), glm::dot(axes.axes[2], p));
        all.off = std::max(all.off, std::abs(glm::dot(axes.axes[0], p - axes.center)));
    }
    all.plan = std::abs(signedArea(inPlan));
    all.plane = std::abs(signedArea(inPlane));
    all.center = corners.front() + axes.center / glm::dvec3(1, 1, heightScale);
    all.normal = upwards(axes.axes[0]);
    all.crossing = crossingEdges(inPlane);
    return all;
}

}  // namespace scancast
