// Views of a cloud from anywhere: near, far, inside, in both projections. Deterministic by number.
#pragma once

#include <glm/geometric.hpp>

#include "renderer/cloud/cloud.hpp"
#include "renderer/select/viewpoint.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

inline View randomView(const Cloud& cloud, std::uint64_t number) {
    const auto u = [&](std::uint64_t stream) { return uniform(number, 100 + stream); };
    const glm::dvec3 size = cloud.bounds[1] - cloud.bounds[0];
    View view;
    view.width = 64 + int(u(1) * 1200);
    view.height = 64 + int(u(2) * 700);
    view.camera.target = cloud.bounds[0] + size * glm::dvec3(u(3), u(4), u(5));
    const glm::dvec3 away(u(6) - 0.5, u(7) - 0.5, u(8) - 0.5);
    view.camera.eye =
        view.camera.target + glm::normalize(away) * glm::length(size) * std::pow(10.0, -3 * u(9)) * 2.0;
    view.camera.fov = 20 + 100 * u(10);
    if (number % 4 == 3) {
        view.camera.projection = Projection::Orthographic;
        view.camera.viewHeight = glm::length(size) * std::pow(10.0, -2 * u(11));
    }
    return view;
}

inline Viewpoint randomViewpoint(const Cloud& cloud, std::uint64_t number) {
    return Viewpoint::create(randomView(cloud, number), cloud.origin, cloud.bounds).value();
}

}  // namespace scancast::test
