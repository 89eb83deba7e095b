#include "client/cpp/orbit_path.hpp"

#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace scancast::client {

Camera orbitedCamera(const Camera& camera, const glm::dvec3& center, const glm::dvec3& axis, double degrees) {
    assert(!camera.viewMatrix);
    const double angle = degrees * std::numbers::pi / 180;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto k = glm::normalize(axis);
    // Rodrigues' formula.
    const auto turned = [&](const glm::dvec3& v) {
        return v * c + glm::cross(k, v) * s + k * (glm::dot(k, v) * (1 - c));
    };
    Camera result = camera;
    result.eye = center + turned(camera.eye - center);
    result.target = center;
    result.up = turned(camera.up);
    return result;
}

}  // namespace scancast::client
