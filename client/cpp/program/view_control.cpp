#include "client/cpp/program/view_control.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace scancast::client {
namespace {

constexpr double steepest = 89 * std::numbers::pi / 180;

/// Right, up and forward of the picture, unit vectors.
struct Axes {
    glm::dvec3 right, up, forward;
};

Axes axesOf(const Camera& camera) {
    const auto forward = glm::normalize(camera.target - camera.eye);
    const auto right = glm::normalize(glm::cross(forward, camera.up));
    return {right, glm::cross(right, forward), forward};
}

/// Cloud units that one px means at the target.
double unitsPerPixel(const Camera& camera, int height) {
    if (camera.projection == Projection::Orthographic) return camera.viewHeight / height;
    const double distance = glm::length(camera.target - camera.eye);
    return 2 * distance * std::tan(camera.fov * std::numbers::pi / 360) / height;
}

Camera moved(Camera camera, const glm::dvec3& by) {
    camera.eye += by;
    camera.target += by;
    return camera;
}

}  // namespace

Camera orbited(const Camera& camera, const glm::dvec3& up, double dx, double dy, int height) {
    const auto pole = glm::normalize(up);
    const auto offset = camera.eye - camera.target;
    const double distance = glm::length(offset);
    const double elevation = std::asin(std::clamp(glm::dot(offset, pole) / distance, -1.0, 1.0));
    // Seen from the pole itself there is no horizontal direction but that of the picture.
    auto flat = offset - pole * glm::dot(offset, pole);
    if (glm::length(flat) < 1e-9 * distance) flat = -(camera.up - pole * glm::dot(camera.up, pole));
    const auto ahead = glm::normalize(flat), aside = glm::cross(pole, ahead);
    const double angle = -dx / height * std::numbers::pi;
    const double raised = std::clamp(elevation + dy / height * std::numbers::pi, -steepest, steepest);
    Camera result = camera;
    result.eye =
        camera.target + distance * (std::cos(raised) * (ahead * std::cos(angle) + aside * std::sin(angle)) +
                                    std::sin(raised) * pole);
    result.up = pole;
    return result;
}

Camera panned(const Camera& camera, double dx, double dy, int height) {
    const auto axes = axesOf(camera);
    const double unit = unitsPerPixel(camera, height);
    return moved(camera, (axes.up * dy - axes.right * dx) * unit);
}

Camera zoomed(const Camera& camera, double factor) {
    Camera result = camera;
    result.eye = camera.target + (camera.eye - camera.target) / factor;
    result.viewHeight = camera.viewHeight / factor;
    return result;
}

Camera flown(const Camera& camera, double forward, double right, double up) {
    const auto axes = axesOf(camera);
    const double distance = glm::length(camera.target - camera.eye);
    return moved(camera, (axes.forward * forward + axes.right * right + axes.up * up) * distance);
}

}  // namespace scancast::client
