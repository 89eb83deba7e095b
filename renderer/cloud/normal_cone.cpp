#include "renderer/cloud/normal_cone.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scancast {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double margin = 1e-6;  // of floats: axis and normals are unit vectors up to rounding
constexpr int anglesTried = 12;

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

NormalCone around(const glm::dvec3& axis, double halfAngle) {
    if (!(halfAngle < pi - margin)) return {};
    return {glm::vec3(axis), float(halfAngle + margin)};
}

bool isUnknown(const NormalCone& c) {
    return !(double(c.halfAngle) < pi);
}

/// The normal that leans away most. By the chord: near the axis a cosine in float tells no angles apart.
const glm::vec3& farthest(std::span<const glm::vec3> normals, const glm::vec3& axis) {
    constexpr std::size_t lanes = 8;
    std::array<float, lanes> most{};
    std::array<std::size_t, lanes> at{};
    const auto look = [&](std::size_t i, std::size_t lane) {
        const glm::vec3 d = normals[i] - axis;
        const float chord = glm::dot(d, d);
        at[lane] = chord > most[lane] ? i : at[lane];
        most[lane] = chord > most[lane] ? chord : most[lane];
    };
    std::size_t i = 0;
    for (; i + lanes <= normals.size(); i += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane) look(i + lane, lane);
    for (; i < normals.size(); ++i) look(i, 0);
    return normals[at[std::size_t(std::max_element(most.begin(), most.end()) - most.begin())]];
}

/// Any direction across.
glm::dvec3 across(const glm::dvec3& a) {
    const glm::dvec3 other = std::abs(a.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(glm::cross(a, other));
}

NormalCone joinTwo(const NormalCone& a, const NormalCone& b) {
    if (isUnknown(a) || isUnknown(b)) return {};
    const glm::dvec3 from = glm::normalize(glm::dvec3(a.axis)), to = glm::normalize(glm::dvec3(b.axis));
    const double between = angleBetween(from, to), ha = a.halfAngle, hb = b.halfAngle;
    if (between + hb <= ha) return a;
    if (between + ha <= hb) return b;
    const double half = (between + ha + hb) / 2;
    const glm::dvec3 side = to - from * glm::dot(from, to);
    const double length = glm::length(side);
    const glm::dvec3 toward = length > 1e-9 ? side / length : across(from);
    const double turn = half - ha;
    return around(from * std::cos(turn) + toward * std::sin(turn), half);
}

}  // namespace

NormalCone coneOf(std::span<const glm::vec3> normals) {
    glm::dvec3 sum(0);
    for (const glm::vec3& n : normals) {
        if (n == glm::vec3(0)) return {};
        sum += glm::dvec3(n);
    }
    if (!(glm::length(sum) > 1e-6 * double(normals.size()))) return {};
    // Towards the middle of the smallest cone: each step leans to the normal that is farthest, by less and
    // less.
    glm::dvec3 axis = glm::normalize(sum), best = axis;
    double least = 4;
    for (int step = 1; step <= anglesTried; ++step) {
        const glm::dvec3 far(farthest(normals, glm::vec3(axis)));
        const double angle = angleBetween(axis, far);
        if (angle < least) {
            least = angle;
            best = axis;
        }
        if ((step > 3 && angle > 0.6 * pi) || angle < margin) break;  // culls nothing, or is a plane's
        axis = glm::normalize(axis + (far - axis) / double(step + 1));
    }
    return around(best, least);
}

NormalCone join(std::span<const NormalCone> cones) {
    if (cones.empty()) return {};
    NormalCone all = cones.front();
    if (isUnknown(all)) return {};
    for (const NormalCone& c : cones.subspan(1)) all = joinTwo(all, c);
    return all;
}

}  // namespace scancast
