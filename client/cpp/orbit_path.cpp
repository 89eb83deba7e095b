#include "client/cpp/orbit_path.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace scancast::client {

Camera orbitedCamera(const Camera& camera, const glm::dvec3& center, double degrees) {
    assert(!camera.viewMatrix);
    const double angle = degrees * std::numbers::pi / 180;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto turned = [&](const glm::dvec3& v) {
        return glm::dvec3(c * v.x - s * v.y, s * v.x + c * v.y, v.z);
    };
    Camera result = camera;
    result.eye = center + turned(camera.eye - center);
    result.target = center;
    result.up = turned(camera.up);
    return result;
}

}  // namespace scancast::client
