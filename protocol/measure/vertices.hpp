// What vertices tell by themselves, whoever picked them: lengths, angles, areas, in double. The one definition of these words
// (docs/measure.md) for server, C++ client and tests. Pure functions; any thread.
//
// x and y are in one unit; z may be in another, of which `heightScale` of the former make one (CrsUnits::heightScale()). Lengths in
// space and areas are in the unit of x and y; `vertical` is in that of z. Z is up.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace scancast {

struct PolylineMeasure {
    struct Leg {
        double length = 0;      ///< in space
        double horizontal = 0;  ///< in plan view
        double vertical = 0;    ///< how much higher its end is than its start
    };
    double length = 0, horizontal = 0;  ///< of all legs
    double vertical = 0;                ///< how much higher the last vertex is than the first
    double climb = 0, descent = 0;      ///< of all legs that go up, and down; ≥ 0
    std::vector<Leg> legs;
};
/// Of two or more vertices.
PolylineMeasure measurePolyline(std::span<const glm::dvec3> vertices, double heightScale = 1);

struct VertexAngle {
    std::optional<double> space;  ///< degrees between the two legs, 0 to 180; nullopt where one has no length
    std::optional<double> plan;   ///< the same in plan view
};
/// At each vertex but the first and the last, of three or more.
std::vector<VertexAngle> measureAngles(std::span<const glm::dvec3> vertices, double heightScale = 1);

struct AreaMeasure {
    double plan = 0;   ///< of the polygon in plan view
    double plane = 0;  ///< of the polygon in its best-fit plane
    double perimeter = 0, planPerimeter = 0;
    glm::dvec3 center{0};  ///< of the corners; on the plane. z in its own unit
    glm::dvec3 normal{0};  ///< of the plane, one long, upwards (or towards +x, +y, where it is upright)
    double off = 0;        ///< the farthest that a corner is from the plane
    /// Two edges that cross each other in that plane; edge i leads from corner i to the next. Areas mean nothing then.
    std::optional<std::array<std::size_t, 2>> crossing;
};
/// Of three or more corners, in either order; the last one is joined to the first.
AreaMeasure measureArea(std::span<const glm::dvec3> corners, double heightScale = 1);

/// Twice counter-clockwise less clockwise, halved: negative where corners go clockwise.
double signedArea(std::span<const glm::dvec2> corners);
/// The first two edges, not neighbours, that touch or cross each other.
std::optional<std::array<std::size_t, 2>> crossingEdges(std::span<const glm::dvec2> corners);
/// One side of a normal for all: upwards; where it lies flat, towards +x, then +y.
glm::dvec3 upwards(const glm::dvec3& normal);

}  // namespace scancast
