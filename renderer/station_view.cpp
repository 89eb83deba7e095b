#include "renderer/station_view.hpp"

#include <glm/geometric.hpp>

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
    // Far enough that orbiting about it shows the surroundings, not one wall.
    const double reach = glm::length(bounds[1] - bounds[0]) * 0.3;
    camera.target = station.position + (*forwards - downwards * camera.up) * (reach > 0 ? reach : 1);
    return camera;
}

}  // namespace scancast
