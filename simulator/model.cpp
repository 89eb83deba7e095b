#include "simulator/model.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {

Patch Patch::trapezoid(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, double taper) {
    Patch patch;
    patch.origin = corner;
    patch.u = u;
    patch.v = v;
    patch.taper = taper;
    patch.normal = glm::normalize(glm::cross(u, v));
    patch.lengthU = glm::length(u);
    patch.lengthV = glm::length(v);
    return patch;
}

Patch Patch::tube(glm::dvec3 base, glm::dvec3 axis, double r0, double r1) {
    Patch patch;
    patch.shape = Shape::Tube;
    patch.origin = base;
    patch.v = axis;
    patch.radius0 = r0;
    patch.radius1 = r1;
    const glm::dvec3 along = glm::normalize(axis);
    const glm::dvec3 helper = std::abs(along.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    patch.normal = glm::normalize(glm::cross(helper, along));
    patch.u = glm::cross(along, patch.normal);
    patch.lengthU = tau * (r0 + r1) / 2;
    patch.lengthV = glm::length(axis);
    patch.taper = r1 / r0;
    return patch;
}

Patch Patch::ball(glm::dvec3 center, double radius) {
    Patch patch;
    patch.shape = Shape::Ball;
    patch.origin = center;
    patch.radius0 = radius;
    patch.lengthU = tau * radius;
    patch.lengthV = 2 * radius;
    return patch;
}

Patch Patch::disc(glm::dvec3 center, double r0, double r1) {
    Patch patch;
    patch.shape = Shape::Disc;
    patch.origin = center;
    patch.radius0 = r0;
    patch.radius1 = r1;
    patch.lengthU = tau * (r0 + r1) / 2;
    patch.lengthV = r1 - r0;
    return patch;
}

Patch Patch::torus(glm::dvec3 center, glm::dvec3 axis, double ring, double tube) {
    Patch patch;
    patch.shape = Shape::Torus;
    patch.origin = center;
    patch.v = glm::normalize(axis);
    patch.radius0 = ring;
    patch.radius1 = tube;
    const glm::dvec3 helper = std::abs(patch.v.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    patch.normal = glm::normalize(glm::cross(helper, patch.v));
    patch.u = glm::cross(patch.v, patch.normal);
    patch.lengthU = tau * ring;
    patch.lengthV = tau * tube;
    return patch;
}

double Patch::area() const {
    if (shape != Shape::Trapezoid) return lengthU * lengthV;
    return glm::length(glm::cross(u, v)) * (1 + taper) / 2;
}

namespace {

/// The height, as a part of the whole, below which a part `b` of a trapezoid's area lies.
double areaHeight(double b, double taper) {
    const double shrink = 1 - taper;
    if (std::abs(shrink) < 1e-9) return b;
    return (1 - std::sqrt(std::max(0.0, 1 - b * shrink * (2 - shrink)))) / shrink;
}

/// The angle around a torus' tube, 0 at its outermost circle, up to which a part `b` of its area lies:
/// angle + thickness · sin(angle) = tau · b, since a strip is the longer the farther out it lies.
double areaAngle(double b, double thickness) {
    const double goal = tau * b;
    double low = 0, high = tau, angle = goal;
    for (int i = 0; i < 40; ++i) {
        const double miss = angle + thickness * std::sin(angle) - goal;
        (miss > 0 ? high : low) = angle;
        const double next = angle - miss / (1 + thickness * std::cos(angle));
        if (std::abs(next - angle) < 1e-15) break;
        angle = next > low && next < high ? next : (low + high) / 2;
    }
    return angle;
}

}  // namespace

std::array<glm::dvec3, 2> Patch::bounds() const {
    // A circle around an axis reaches sqrt(1 - axis²) of its radius along each coordinate.
    const auto reach = [](const glm::dvec3& axis, double radius) {
        return glm::sqrt(glm::max(glm::dvec3(0), 1.0 - axis * axis)) * radius;
    };
    glm::dvec3 low(1e300), high(-1e300);
    const auto include = [&](const glm::dvec3& at, const glm::dvec3& margin) {
        low = glm::min(low, at - margin);
        high = glm::max(high, at + margin);
    };
    switch (shape) {
        case Shape::Trapezoid:
            for (const glm::dvec3& at : {origin, origin + u, origin + v, origin + u * taper + v})
                include(at, glm::dvec3(0));
            break;
        case Shape::Tube:
            include(origin, reach(glm::normalize(v), radius0));
            include(origin + v, reach(glm::normalize(v), radius1));
            break;
        case Shape::Ball:
            include(origin, glm::dvec3(radius0));
            break;
        case Shape::Disc:
            include(origin, {radius1, radius1, 0});
            break;
        case Shape::Torus:
            include(origin, reach(v, radius0) + radius1);
            break;
    }
    return {low, high};
}

SurfacePoint Patch::at(double a, double b) const {
    SurfacePoint point;
    switch (shape) {
        case Shape::Trapezoid: {
            const double height = areaHeight(b, taper), across = a * (1 - (1 - taper) * height);
            point.position = origin + u * across + v * height;
            point.normal = normal;
            point.s = lengthU * across;
            point.t = lengthV * height;
            break;
        }
        case Shape::Tube: {
            const double height = areaHeight(b, taper), radius = radius0 + (radius1 - radius0) * height;
            const glm::dvec3 out = normal * std::cos(tau * a) + u * std::sin(tau * a);
            point.position = origin + v * height + out * radius;
            point.normal = out;
            point.s = lengthU * a;
            point.t = lengthV * height;
            break;
        }
        case Shape::Ball: {
            const double z = 2 * b - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
            const glm::dvec3 out(r * std::cos(tau * a), r * std::sin(tau * a), z);
            point.position = origin + out * radius0;
            point.normal = out;
            point.s = lengthU * a;
            point.t = lengthV * b;
            break;
        }
        case Shape::Disc: {
            const double r = std::sqrt(radius0 * radius0 + (radius1 * radius1 - radius0 * radius0) * b);
            point.position = origin + glm::dvec3(r * std::cos(tau * a), r * std::sin(tau * a), 0);
            point.normal = {0, 0, 1};
            point.s = lengthU * a;
            point.t = r;
            break;
        }
        case Shape::Torus: {
            const double angle = areaAngle(b, radius1 / radius0);
            const glm::dvec3 out = normal * std::cos(tau * a) + u * std::sin(tau * a);
            point.normal = out * std::cos(angle) + v * std::sin(angle);
            point.position = origin + out * radius0 + (out * std::cos(angle) + v * std::sin(angle)) * radius1;
            point.s = lengthU * a;
            point.t = lengthV * angle / tau;
            break;
        }
    }
    return point;
}

Occluder Occluder::box(glm::vec3 low, glm::vec3 high) {
    Occluder body;
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 normal(0);
        normal[axis] = 1;
        body.addPlane(normal, high);
        body.addPlane(-normal, low);
    }
    body.center = (low + high) * 0.5F;
    body.radius = glm::length(high - low) * 0.5F;
    return body;
}

Occluder Occluder::leaves(glm::vec3 center, float radius) {
    Occluder ball;
    ball.center = center;
    ball.radius = radius;
    return ball;
}

void Occluder::addPlane(glm::vec3 normal, glm::vec3 through) {
    planes[std::size_t(planeCount++)] = glm::vec4(normal, glm::dot(normal, through));
}

bool Occluder::blocks(glm::vec3 from, glm::vec3 direction, float reach) const {
    if (planeCount == 0) {
        const glm::vec3 to = center - from;
        const float along = glm::dot(to, direction), gap2 = glm::dot(to, to) - along * along;
        if (gap2 > radius * radius || along < 0) return false;
        const float enter = along - std::sqrt(radius * radius - gap2);
        if (enter < 0 || enter > reach) return false;
        // Leaves let specks of light through, the more the nearer to the crown's rim.
        const glm::vec3 hit = from + direction * enter;
        const float leaf = smoothNoise({hit.x * 3.1F + hit.z, hit.y * 3.1F - hit.z}, 77);
        return leaf > 0.28F + 0.4F * gap2 / (radius * radius);
    }
    float enter = 0, leave = reach;
    for (int i = 0; i < planeCount; ++i) {
        const glm::vec3 normal(planes[std::size_t(i)]);
        const float slope = glm::dot(normal, direction);
        const float height = planes[std::size_t(i)].w - glm::dot(normal, from);
        if (std::abs(slope) < 1e-7F) {
            if (height < 0) return false;
        } else if (slope > 0) {
            leave = std::min(leave, height / slope);
        } else {
            enter = std::max(enter, height / slope);
        }
        if (enter > leave) return false;
    }
    return true;
}

float Occluder::distance(glm::vec3 at) const {
    if (planeCount == 0) return glm::distance(at, center) - radius;
    float largest = -1e9F;
    for (int i = 0; i < planeCount; ++i) {
        const glm::vec4& plane = planes[std::size_t(i)];
        largest = std::max(largest, glm::dot(glm::vec3(plane), at) - plane.w);
    }
    return largest;
}

void Model::addBox(glm::dvec3 center, glm::dvec3 size, const Material* material, double angle, double density,
                   bool bottom) {
    const glm::dvec3 x = glm::dvec3(std::cos(angle), std::sin(angle), 0) * size.x;
    const glm::dvec3 y = glm::dvec3(-std::sin(angle), std::cos(angle), 0) * size.y;
    const glm::dvec3 z(0, 0, size.z), low = center - (x + y + z) * 0.5;
    add(Patch::trapezoid(low, x, z), material, density);
    add(Patch::trapezoid(low + x, y, z), material, density);
    add(Patch::trapezoid(low + x + y, -x, z), material, density);
    add(Patch::trapezoid(low + y, -y, z), material, density);
    add(Patch::trapezoid(low + z, x, y), material, density);
    if (bottom) add(Patch::trapezoid(low, y, x), material, density);
}

}  // namespace scancast
