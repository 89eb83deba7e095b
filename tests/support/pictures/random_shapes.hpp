// Shapes that cut, by a number: boxes and half-spaces of every kind around a place.
#pragma once

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "protocol/view/clip_shapes.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

/// Of about `reach` cloud units, so that they leave something of what is as large, and take something away.
inline ClipShapes randomShapes(std::uint64_t number, const glm::dvec3& around, double reach) {
    std::uint64_t asked = 0;
    const auto within = [&](double low, double high) {
        return low + (high - low) * uniform(number, ++asked);
    };
    const auto coin = [&] { return within(0, 1) < 0.5; };
    const auto spread = [&](double most) {
        const double x = within(-most, most), y = within(-most, most);
        return glm::dvec3(x, y, within(-most, most));
    };
    ClipShapes shapes;
    const auto count = 1 + number % mostClipShapes;
    for (std::size_t i = 0; i < count; ++i) {
        const bool level = within(0, 1) < 0.3;  // faces that lie across the axes
        if (within(0, 1) < 0.25) {
            const glm::dvec3 normal = level ? glm::dvec3(0, 0, coin() ? -2 : 2) : spread(1);
            // Far enough out to leave something on its side.
            shapes.push_back(HalfSpace{around - glm::normalize(normal) * within(0, 0.5 * reach), normal});
        } else {
            TurnedBox box;
            box.center = around + spread(0.6 * reach);
            box.size = glm::abs(spread(0.6 * reach)) + 0.3 * reach;
            box.turn = level ? glm::dvec3(coin() ? 0 : 90, 0, 0) : spread(180);
            box.outside = coin();
            shapes.push_back(box);
        }
    }
    return shapes;
}

/// Whether single precision may see a point (cloud-relative) on the other side of one of the faces.
inline bool nearAFace(const ClipRegions& regions, const glm::dvec3& p, double tolerance) {
    for (const auto* const list : {&regions.kept, &regions.dropped})
        for (const ConvexRegion& region : *list)
            for (int i = 0; i < region.count; ++i) {
                const glm::dvec4& plane = region.planes[static_cast<std::size_t>(i)];
                if (std::abs(glm::dot(glm::dvec3(plane), p) + plane.w) <= tolerance) return true;
            }
    return false;
}

}  // namespace scancast::test
