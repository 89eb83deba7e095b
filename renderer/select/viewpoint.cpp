#include "renderer/select/viewpoint.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>

namespace scancast {

namespace {

/// Rigid world → view transform of a camera, composed relative to `origin`, so that no large number survives.
glm::dmat4 lookFrom(const Camera& camera, const glm::dvec3& origin) {
    if (camera.viewMatrix) {
        glm::dmat4 worldToView;
        for (int i = 0; i < 16; ++i)
            worldToView[i / 4][i % 4] = (*camera.viewMatrix)[static_cast<std::size_t>(i)];
        // view = R·(origin + p) + t  →  R·p + (R·origin + t)
        worldToView[3] = worldToView * glm::dvec4(origin, 1);
        return worldToView;
    }
    const glm::dvec3 back = glm::normalize(camera.eye - camera.target);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    const glm::dvec3 up = glm::cross(back, right);
    const glm::dvec3 eye = camera.eye - origin;
    glm::dmat4 m(1);
    for (int i = 0; i < 3; ++i) m[i] = {right[i], up[i], back[i], 0};
    m[3] = {-glm::dot(right, eye), -glm::dot(up, eye), -glm::dot(back, eye), 1};
    return m;
}

}  // namespace

Expected<Viewpoint> Viewpoint::create(const View& view, const glm::dvec3& origin,
                                      const std::array<glm::dvec3, 2>& bounds) {
    if (auto ok = validate(view); !ok) return passOn(ok);
    Viewpoint v;
    v.width = view.width;
    v.height = view.height;
    v.projection = view.camera.projection;
    v.cloudToView = lookFrom(view.camera, origin);
    v.pixelsPerUnit = v.projection == Projection::Perspective
                          ? view.height / (2 * std::tan(view.camera.fov * std::numbers::pi / 360))
                          : view.height / view.camera.viewHeight;

    const double diagonal = glm::length(bounds[1] - bounds[0]);
    if (v.projection == Projection::Perspective) {
        // Depth is kept as a float's bits, not in a fixed-point buffer, so a tiny near costs no precision.
        v.near = view.camera.near.value_or(std::max(diagonal * 1e-5, 1e-9));
    } else {
        // Nothing is behind an orthographic camera unless near says so: start in front of the whole cloud.
        const glm::dvec3 center = (bounds[0] + bounds[1]) * 0.5 - origin;
        const double depth = -(v.cloudToView * glm::dvec4(center, 1)).z;
        const double first = depth - diagonal * 0.5 - 1e-3 * diagonal - 1e-9;
        if (!view.camera.near && first <= 0) {
            // Depths must be positive: move the camera back along its own axis, which changes no parallel
            // picture.
            const double shift = diagonal * 1e-3 + 1e-9 - first;
            v.cloudToView[3].z -= shift;
            v.near = first + shift;
        } else {
            v.near = view.camera.near.value_or(first);
        }
    }
    v.far = view.camera.far.value_or(std::numeric_limits<double>::infinity());
    if (!(v.near < v.far)) {
        return fail(ErrorCode::ImpossibleView,
                    "near must be smaller than far, so that something lies between", "near");
    }
    return v;
}

glm::dvec3 Viewpoint::project(const glm::dvec3& viewSpace) const {
    const double depth = -viewSpace.z;
    const double scale = q(depth);
    return {width * 0.5 + viewSpace.x * scale, height * 0.5 - viewSpace.y * scale, depth};
}

glm::dvec3 Viewpoint::eye() const {
    const glm::dmat3 rotation(cloudToView);
    return -(glm::transpose(rotation) * glm::dvec3(cloudToView[3]));
}

glm::dvec3 Viewpoint::direction() const {
    return -glm::dvec3(glm::row(cloudToView, 2));
}

std::array<glm::dvec4, 6> Viewpoint::frustum() const {
    const double halfWidth = width * 0.5 / pixelsPerUnit;
    const double halfHeight = height * 0.5 / pixelsPerUnit;
    std::array<glm::dvec4, 6> planes;  // in view space first
    if (projection == Projection::Perspective) {
        const double nx = 1 / std::hypot(1.0, halfWidth), ny = 1 / std::hypot(1.0, halfHeight);
        planes[0] = {nx, 0, -halfWidth * nx, 0};
        planes[1] = {-nx, 0, -halfWidth * nx, 0};
        planes[2] = {0, ny, -halfHeight * ny, 0};
        planes[3] = {0, -ny, -halfHeight * ny, 0};
    } else {
        planes[0] = {1, 0, 0, halfWidth};
        planes[1] = {-1, 0, 0, halfWidth};
        planes[2] = {0, 1, 0, halfHeight};
        planes[3] = {0, -1, 0, halfHeight};
    }
    planes[4] = {0, 0, -1, -near};
    planes[5] = std::isfinite(far) ? glm::dvec4{0, 0, 1, far} : glm::dvec4{0, 0, 0, 1};
    // A plane p in view space is Mᵀp in cloud space.
    const glm::dmat4 transposed = glm::transpose(cloudToView);
    for (auto& plane : planes) {
        const bool infinite = glm::dvec3(plane) == glm::dvec3(0);
        if (!infinite) plane = transposed * plane;
    }
    return planes;
}

}  // namespace scancast
