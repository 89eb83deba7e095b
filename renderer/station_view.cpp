#include "renderer/station_view.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

namespace scancast {
namespace {

constexpr double wideFov = 75;  // degrees: as of views from inside (renderer/look)
constexpr double downwards =
    0.09;  // of the way forwards: scanners stand at the height of eyes, things lie lower

/// The part of `v` that is level, as a unit vector; nullopt where nearly all of it is up or down.
std::optional<glm::dvec3> level(const glm::dvec3& v, const glm::dvec3& up) {
    const glm::dvec3 flat = v - glm::dot(v, up) * up;
    if (!(glm::length(flat) > 0.05 * glm::length(v))) return std::nullopt;
    return unitVector(flat);
}

constexpr double widestFov = 150;  // degrees: beyond, a flat picture shows little but its edges

/// Far enough that orbiting about it shows the surroundings, not one wall.
double reachIn(const Cloud& cloud) {
    const auto& bounds = cloud.look ? cloud.look->bounds : cloud.bounds;
    const double reach = glm::length(bounds[1] - bounds[0]) * 0.3;
    return reach > 0 ? reach : 1;
}

/// Of the angle that a flat photo covers; 0 where it is not known, or none that a flat photo can have.
double halfTangentOf(double angle) {
    return angle > 0 && angle < std::numbers::pi ? std::tan(angle / 2) : 0;
}

/// The vertical angle, degrees, at which a picture of this `aspect` shows all of a flat photo.
double fovOf(const Photo& photo, double aspect) {
    double across = halfTangentOf(photo.angles[0]), down = halfTangentOf(photo.angles[1]);
    const double shape = photo.width > 0 && photo.height > 0 ? double(photo.width) / photo.height : 0;
    if (across == 0 && shape > 0) across = down * shape;
    if (down == 0 && shape > 0) down = across / shape;
    const double needed = std::max(down, across / aspect);
    if (!(needed > 0)) return wideFov;
    return std::clamp(glm::degrees(2 * std::atan(needed)), 0.1, widestFov);
}

}  // namespace

Camera stationCamera(const Cloud& cloud, const Station& station) {
    const auto& bounds = cloud.look ? cloud.look->bounds : cloud.bounds;
    Camera camera;
    camera.up = cloud.look ? cloud.look->up : glm::dvec3(0, 0, 1);
    camera.fov = wideFov;
    camera.eye = station.position;
    std::optional<glm::dvec3> forwards;
    if (station.forwards) forwards = level(*station.forwards, camera.up);
    if (!forwards) forwards = level((bounds[0] + bounds[1]) * 0.5 - station.position, camera.up);
    if (!forwards) forwards = level({0, 1, 0}, camera.up);
    if (!forwards) forwards = level({1, 0, 0}, camera.up);
    camera.target = station.position + (*forwards - downwards * camera.up) * reachIn(cloud);
    return camera;
}

std::optional<Camera> photoCamera(const Cloud& cloud, const Photo& photo, double aspect) {
    if (!photo.pose) return std::nullopt;
    const Photo::Pose& pose = *photo.pose;
    if (photo.projection != Photo::Projection::Pinhole)
        return stationCamera(cloud, {.position = pose.position, .forwards = pose.forwards});
    Camera camera;
    camera.eye = pose.position;
    camera.target = pose.position + pose.forwards * reachIn(cloud);
    camera.up = pose.up;
    camera.fov = fovOf(photo, aspect);
    return camera;
}

}  // namespace scancast
