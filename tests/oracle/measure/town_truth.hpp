// The generated town's houses, as its generator made them, and what a vertical ray says of their roofs: what measures of its scan are held
// against. Used by oracle_measure and bench_measure.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/measure/vertices.hpp"
#include "renderer/pick/pick.hpp"
#include "tests/ground_truth/ray_caster.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

/// A house's body without what stands on it and sticks out of it; file coordinates.
struct TownHouse {
    std::array<glm::dvec3, 4>
        corners;  ///< of its footprint, counter-clockwise from the front's, at the height of the pavement
    double width = 0, depth = 0;  ///< of the front; from front to back
    double eaves = 0, ridge = 0;  ///< heights over the pavement

    double area() const { return width * depth; }
    double volume() const { return area() * (eaves + ridge) / 2; }
};

/// All houses that are boxes with a ridge roof: bodies of six planes, four upright and two of the roof.
inline std::vector<TownHouse> townHouses(const RayCaster& town, double pavement) {
    std::vector<TownHouse> houses;
    for (const Occluder& body : town.model().occluders) {
        if (!body.solid || body.planeCount != 6) continue;
        std::vector<glm::dvec4> upright, roof;
        for (int i = 0; i < 6; ++i) {
            const glm::dvec4 plane(body.planes[std::size_t(i)]);
            (std::abs(plane.z) < 1e-6 ? upright : roof).push_back(plane);
        }
        if (upright.size() != 4 || roof.size() != 2 || roof[0].z < 0.1 || roof[1].z < 0.1) continue;
        // Front, back, and both ends, as the generator adds them: n·x ≤ w.
        const auto meet = [](const glm::dvec4& a, const glm::dvec4& b) {
            const double determinant = a.x * b.y - a.y * b.x;
            return glm::dvec2((a.w * b.y - b.w * a.y) / determinant, (a.x * b.w - b.x * a.w) / determinant);
        };
        const glm::dvec4 &front = upright[0], &back = upright[1], &left = upright[2], &right = upright[3];
        const std::array flat{meet(front, left), meet(front, right), meet(back, right), meet(back, left)};
        TownHouse house;
        house.width = glm::distance(flat[0], flat[1]);
        house.depth = glm::distance(flat[1], flat[2]);
        const auto roofAt = [&](const glm::dvec2& p) {
            double z = std::numeric_limits<double>::infinity();
            for (const glm::dvec4& plane : roof)
                z = std::min(z, (plane.w - plane.x * p.x - plane.y * p.y) / plane.z);
            return z;
        };
        house.eaves = roofAt(flat[0]) - pavement;
        house.ridge = roofAt((flat[0] + flat[3]) / 2.0) - pavement;
        for (std::size_t i = 0; i < 4; ++i) house.corners[i] = town.origin() + glm::dvec3(flat[i], pavement);
        const glm::dvec2 u = flat[1] - flat[0], v = flat[3] - flat[0];
        if (u.x * v.y - u.y * v.x < 0) {
            // The other way round, and the front stays between the first two.
            std::swap(house.corners[0], house.corners[1]);
            std::swap(house.corners[2], house.corners[3]);
        }
        houses.push_back(house);
    }
    return houses;
}

/// Along a house's edges stand the walls of its neighbours, whose points are as high as their roofs and, by a scanner's noise, on either
/// side: volumes are measured so far inside.
inline constexpr double clearOfNeighbours = 0.2;

/// A rectangle, so much smaller on each side.
inline std::array<glm::dvec3, 4> inset(std::array<glm::dvec3, 4> corners, double by) {
    const glm::dvec3 u = glm::normalize(corners[1] - corners[0]), v = glm::normalize(corners[3] - corners[0]);
    corners[0] += by * (u + v);
    corners[1] += by * (v - u);
    corners[2] -= by * (u + v);
    corners[3] += by * (u - v);
    return corners;
}

struct TrueVolume {
    double above = 0, below = 0;
};

/// Over a quadrilateral that is a rectangle, from a height: by rays from above, `step` apart.
inline TrueVolume volumeByRays(const RayCaster& town, const std::array<glm::dvec3, 4>& corners, double base,
                               double step) {
    const glm::dvec3 u = corners[1] - corners[0], v = corners[3] - corners[0];
    const int across = int(std::ceil(glm::length(u) / step)), along = int(std::ceil(glm::length(v) / step));
    const double part = glm::length(u) / across * glm::length(v) / along;
    TrueVolume volume;
    for (int i = 0; i < across; ++i)
        for (int j = 0; j < along; ++j) {
            glm::dvec3 from = corners[0] + u * ((i + 0.5) / across) + v * ((j + 0.5) / along);
            from.z = base + 200;
            const auto hit = town.cast({from, glm::dvec3(0, 0, -1)}, 0, 400);
            if (!hit) continue;
            const double over = hit->position.z - base;
            (over > 0 ? volume.above : volume.below) += part * std::abs(over);
        }
    return volume;
}

/// The scan's point that somebody gets who picks this very place: seen from `away` along `from`, in the middle of a pixel.
inline glm::dvec3 pickedAt(const Cloud& cloud, const glm::dvec3& place, const glm::dvec3& from) {
    constexpr double away = 5;
    View view;
    view.camera.target = place;
    view.camera.eye = place + away * from;
    view.camera.up = std::abs(from.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    view.width = view.height = 1;
    const auto picked = pick(cloud, view, {0, 0}, away);
    return picked && *picked ? (*picked)->point.position : glm::dvec3(std::nan(""));
}

/// The area of a house's front between its corners, 0.3 m off the ground and at the eaves, where they are picked.
inline double frontArea(const Cloud& cloud, const TownHouse& house) {
    const glm::dvec3 along = house.corners[1] - house.corners[0];
    const glm::dvec3 out = glm::normalize(glm::cross(along, glm::dvec3(0, 0, 1)));
    std::vector<glm::dvec3> corners;
    const std::array<std::pair<std::size_t, double>, 4> places{
        {{0, 0.3}, {1, 0.3}, {1, house.eaves}, {0, house.eaves}}};
    for (const auto& [end, height] : places)
        corners.push_back(pickedAt(cloud, house.corners[end] + glm::dvec3(0, 0, height), out));
    return measureArea(corners).plane;
}

struct Length {
    double truth = 0, measured = 0;
    double off =
        0;  ///< how far the scan's nearest point is from the place meant at its end: no pick of a point can be nearer
};
/// Between places all over the town that are seen from above, slantwise, and what is picked there.
inline std::vector<Length> lengthsBetweenPicks(const Cloud& cloud, const RayCaster& town, int count) {
    std::vector<Length> lengths;
    std::optional<glm::dvec3> last, lastPicked;
    for (std::uint64_t i = 0; int(lengths.size()) < count && i < 100'000; ++i) {
        const glm::dvec3 from = glm::normalize(glm::dvec3(uniform(i, 1) - 0.5, uniform(i, 2) - 0.5, 0.6));
        const glm::dvec3 ground =
            town.origin() + glm::dvec3(150 * uniform(i, 3) - 75, 150 * uniform(i, 4) - 75, 0);
        const auto hit = town.cast({ground + 100.0 * from, -from}, 0, 150);
        // Leaves have no surface, and what little things are made of is hardly scanned.
        if (!hit || hit->classification == 5 || hit->classification == 4 || hit->classification == 3)
            continue;
        const glm::dvec3 picked = pickedAt(cloud, hit->position, from);
        if (last)
            lengths.push_back({glm::distance(*last, hit->position), glm::distance(*lastPicked, picked),
                               glm::distance(hit->position, picked)});
        last = hit->position;
        lastPicked = picked;
    }
    return lengths;
}

}  // namespace scancast::test
