#include "protocol/view/clip_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace scancast {
namespace {

/// By how many units in the last place of the largest coordinate faces lie farther out.
constexpr double slackInUnits = 16 * 0x1p-52;

struct Turn {
    double cosine, sine;
};

Turn turnBy(double degrees) {
    const double quarters = degrees / 90;
    if (quarters == std::floor(quarters)) {
        constexpr std::array<Turn, 4> exact{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
        const auto at = static_cast<int>(std::fmod(quarters, 4.0));
        return exact[static_cast<std::size_t>(at & 3)];
    }
    const double radians = degrees * (std::numbers::pi / 180);
    return {std::cos(radians), std::sin(radians)};
}

double largest(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Inside is where the normal points to; `place` and `origin` in the file's coordinates.
glm::dvec4 plane(const glm::dvec3& normal, const glm::dvec3& place, double within, const glm::dvec3& origin) {
    return {normal, within - glm::dot(normal, place - origin)};
}

ConvexRegion regionOf(const TurnedBox& box, const glm::dvec3& origin) {
    const double slack = slackInUnits * std::max({largest(box.center), largest(box.size), largest(origin)});
    ConvexRegion region;
    const auto axes = axesOf(box);
    for (int a = 0; a < 3; ++a)
        for (const double side : {1.0, -1.0})
            region.planes[static_cast<std::size_t>(region.count++)] =
                plane(side * axes[static_cast<std::size_t>(a)], box.center, box.size[a] / 2 + slack, origin);
    return region;
}

/// What it does not keep.
ConvexRegion beyond(const HalfSpace& half, const glm::dvec3& origin) {
    const double slack = slackInUnits * std::max(largest(half.point), largest(origin));
    // Safe for the tiniest normals, whose squares would vanish.
    const glm::dvec3 normal = glm::normalize(half.normal / largest(half.normal));
    return {{plane(-normal, half.point, -slack, origin)}, 1};
}

}  // namespace

std::array<glm::dvec3, 3> axesOf(const TurnedBox& box) {
    const Turn yaw = turnBy(box.turn.x), pitch = turnBy(box.turn.y), roll = turnBy(box.turn.z);
    const double cy = yaw.cosine, sy = yaw.sine, cp = pitch.cosine, sp = pitch.sine, cr = roll.cosine,
                 sr = roll.sine;
    return {glm::dvec3(cy * cp, sy * cp, -sp),
            glm::dvec3(cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr),
            glm::dvec3(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr)};
}

bool ConvexRegion::contains(const glm::dvec3& p) const {
    return std::all_of(planes.begin(), planes.begin() + count, [&](const glm::dvec4& plane) {
        return glm::dot(glm::dvec3(plane), p) + plane.w >= 0;
    });
}

Overlap ConvexRegion::overlap(const glm::dvec3& low, const glm::dvec3& high) const {
    const glm::dvec3 center = (low + high) * 0.5, half = (high - low) * 0.5;
    Overlap found = Overlap::All;
    for (int i = 0; i < count; ++i) {
        const glm::dvec4& plane = planes[static_cast<std::size_t>(i)];
        const double middle = glm::dot(glm::dvec3(plane), center) + plane.w;
        const double reach =
            std::abs(plane.x) * half.x + std::abs(plane.y) * half.y + std::abs(plane.z) * half.z;
        if (middle + reach < 0) return Overlap::None;
        if (middle - reach < 0) found = Overlap::Some;
    }
    return found;
}

bool ClipRegions::contains(const glm::dvec3& p) const {
    const auto has = [&](const ConvexRegion& region) { return region.contains(p); };
    return std::ranges::none_of(dropped, has) && (kept.empty() || std::ranges::any_of(kept, has));
}

Overlap ClipRegions::overlap(const glm::dvec3& low, const glm::dvec3& high) const {
    bool some = false;
    for (const ConvexRegion& region : dropped) {
        const Overlap taken = region.overlap(low, high);
        if (taken == Overlap::All) return Overlap::None;
        some = some || taken == Overlap::Some;
    }
    Overlap most = kept.empty() ? Overlap::All : Overlap::None;
    for (const ConvexRegion& region : kept) most = std::max(most, region.overlap(low, high));
    return some ? std::min(most, Overlap::Some) : most;
}

ClipRegions clipRegions(std::span<const ClipShape> shapes, const glm::dvec3& origin) {
    ClipRegions regions;
    for (const ClipShape& shape : shapes) {
        if (const auto* const half = std::get_if<HalfSpace>(&shape)) {
            regions.dropped.push_back(beyond(*half, origin));
        } else {
            const TurnedBox& box = std::get<TurnedBox>(shape);
            (box.outside ? regions.dropped : regions.kept).push_back(regionOf(box, origin));
        }
    }
    return regions;
}

bool contains(std::span<const ClipShape> shapes, const glm::dvec3& point) {
    return clipRegions(shapes, point).contains(glm::dvec3(0));
}

}  // namespace scancast
