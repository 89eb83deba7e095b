// The shapes that a view is cut by (word `clips`): turned boxes and half-spaces, as they are said; and as convex regions of
// planes, as everything that looks at points by them has them - pictures, picks, profiles, exports.
//
// A point is drawn if it lies in every half-space, outside of every box that keeps what is outside, and, where boxes keep what
// is inside, in at least one of those. Faces belong to their box, and to their half-space: with the same box, inside and
// outside, every point is drawn once. Coordinates are the file's, doubles. Pure functions of plain values; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <variant>
#include <vector>

namespace scancast {

struct TurnedBox {
    glm::dvec3 center{0};
    glm::dvec3 size{1};  ///< full lengths along its own axes, > 0
    glm::dvec3 turn{
        0};  ///< yaw about Z, then pitch about its Y, then roll about its X; degrees, by the right-hand rule
    bool outside = false;  ///< keeps what lies outside of it
    bool operator==(const TurnedBox&) const = default;
};

/// Keeps the side that the normal points to.
struct HalfSpace {
    glm::dvec3 point{0};         ///< on its plane
    glm::dvec3 normal{0, 0, 1};  ///< of any length but 0
    bool operator==(const HalfSpace&) const = default;
};

using ClipShape = std::variant<TurnedBox, HalfSpace>;
using ClipShapes = std::vector<ClipShape>;
inline constexpr std::size_t mostClipShapes = 8;

/// The box's own axes, unit vectors. Turns by whole quarters are exact.
std::array<glm::dvec3, 3> axesOf(const TurnedBox& box);

/// Of a box along the axes: how much of it is meant.
enum class Overlap : std::uint8_t { None, Some, All };

/// A convex piece of space: inside all planes, dot(xyz, p) + w ≥ 0, unit normals.
struct ConvexRegion {
    static constexpr int mostPlanes = 6;
    std::array<glm::dvec4, mostPlanes> planes{};
    int count = 0;

    bool contains(const glm::dvec3& p) const;
    /// Some may be said of a box near an edge of the region, of which nothing lies inside.
    Overlap overlap(const glm::dvec3& low, const glm::dvec3& high) const;
};

/// What shapes leave of space: what lies in none of `dropped` and, where there are any `kept`, in at least one of those.
struct ClipRegions {
    std::vector<ConvexRegion> kept, dropped;

    bool empty() const { return kept.empty() && dropped.empty(); }
    bool contains(const glm::dvec3& p) const;
    /// How much of a box is left; None and All are certain.
    Overlap overlap(const glm::dvec3& low, const glm::dvec3& high) const;
};

/// Of sound shapes, in coordinates relative to `origin`, which should lie near the points that are to be looked at: then no
/// large coordinate is rounded. Faces lie a few units in the last place of the file's coordinates farther out, so that
/// what is written to lie on them does.
ClipRegions clipRegions(std::span<const ClipShape> shapes, const glm::dvec3& origin);

/// Whether a view that is cut by the shapes draws a point of the file. For many points, make regions once.
bool contains(std::span<const ClipShape> shapes, const glm::dvec3& point);

}  // namespace scancast
