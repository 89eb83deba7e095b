#include "renderer/method/light.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace scancast {
namespace {

/// What the headlight gives a surface of a picture, on average: more on walls and ground that face the viewer, less on
/// things that are round. Measured: docs/spec/shading.md §2.
constexpr double meanHeadlight = 0.91;

/// Of a scene that is half flat ground and half walls in all directions.
double meanSunlight(double elevation) {
    constexpr double pi = 3.14159265358979323846;
    return 0.5 * std::sin(elevation) + 0.5 * std::cos(elevation) / pi;
}

}  // namespace

glm::dvec3 wayToSun(const std::array<double, 2>& azimuthElevation, const glm::dvec3& up) {
    const double azimuth = glm::radians(azimuthElevation[0]), elevation = glm::radians(azimuthElevation[1]);
    glm::dvec3 north = glm::dvec3(0, 1, 0) - up * up.y;
    if (glm::length(north) < 1e-3) north = glm::dvec3(0, 0, up.y > 0 ? -1 : 1);
    north = glm::normalize(north - up * glm::dot(north, up));
    const glm::dvec3 east = glm::cross(north, up);
    return (north * std::cos(azimuth) + east * std::sin(azimuth)) * std::cos(elevation) +
           up * std::sin(elevation);
}

std::array<double, 2> sunAlong(const glm::dvec3& way, const glm::dvec3& up) {
    const glm::dvec3 w = glm::normalize(way);
    const double toNorth = glm::dot(w, wayToSun({0, 0}, up)), toEast = glm::dot(w, wayToSun({90, 0}, up));
    return {std::round(glm::degrees(std::atan2(toEast, toNorth))),
            std::round(glm::degrees(std::asin(std::clamp(glm::dot(w, up), -1.0, 1.0))))};
}

PhongPass phongPass(const LightRig& light, const glm::dvec3& up) {
    const double sunlight = light.sun ? light.sunlight : 0;
    double mean = light.ambient + light.headlight * meanHeadlight;
    if (light.sun) mean += sunlight * meanSunlight(glm::radians((*light.sun)[1]));
    const double factor = mean > 0 ? 1 / mean : 0;
    PhongPass pass;
    pass.ambient = static_cast<float>(light.ambient * factor);
    pass.headlight = static_cast<float>(light.headlight * factor);
    pass.sunlight = static_cast<float>(sunlight * factor);
    pass.shine = static_cast<float>(light.shine);
    pass.shadows = castsShadows(light);
    if (light.sun) {
        const glm::dvec3 way = wayToSun(*light.sun, up);
        for (std::size_t axis = 0; axis < 3; ++axis)
            pass.sun[axis] = static_cast<float>(way[static_cast<int>(axis)]);
    }
    return pass;
}

bool castsShadows(const LightRig& light) {
    return light.sun && light.sunlight > 0 && light.shadow > 0;
}

ShadowPass shadowPass(const LightRig& light, Shading shading) {
    ShadowPass pass;
    pass.strength = static_cast<float>(light.shadow);
    // Colours that nothing else lights are as if lit by the sky and the sun.
    if (shading != Shading::Phong)
        pass.share = static_cast<float>(light.sunlight / (light.ambient + light.sunlight));
    return pass;
}

OcclusionPass occlusionPass(const LightRig& light, int height) {
    constexpr double ofHeight = 0.05;
    return {static_cast<float>(light.occlusion.value_or(0)), static_cast<float>(height * ofHeight)};
}

}  // namespace scancast
