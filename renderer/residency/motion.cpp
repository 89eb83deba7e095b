#include "renderer/residency/motion.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace scancast {

namespace {

// Two views further apart than this are two looks, not one movement.
constexpr double longestStep = 0.5;
// However short the step, its error grows with this at most.
constexpr double mostSteps = 10;
// A camera that turns faster would be round the corner by then; nobody can say where.
constexpr double widestTurn = 1.5;

/// `to`, turned and stretched `steps` times as far again as `from` was turned and stretched into it.
std::optional<glm::dvec3> goOn(const glm::dvec3& from, const glm::dvec3& to, double steps) {
    const double before = glm::length(from), now = glm::length(to);
    if (!(before > 0) || !(now > 0)) return std::nullopt;
    const glm::dvec3 axis = glm::cross(from / before, to / now);
    const double sine = glm::length(axis);
    const double angle = std::atan2(sine, glm::dot(from, to) / (before * now));
    const double stretch = std::pow(std::clamp(now / before, 0.5, 2.0), steps);
    if (!(sine > 1e-12)) return to * stretch;
    const double turn = std::min(angle * steps, widestTurn);
    return glm::angleAxis(turn, axis / sine) * to * stretch;
}

}  // namespace

std::optional<Camera> extrapolate(const Camera& before, const Camera& now, double elapsed, double ahead) {
    if (before.viewMatrix || now.viewMatrix || before.projection != now.projection) return std::nullopt;
    if (!(elapsed > 0) || elapsed > longestStep || !(ahead > 0)) return std::nullopt;
    if (before.eye == now.eye && before.target == now.target && before.viewHeight == now.viewHeight &&
        before.fov == now.fov) {
        return std::nullopt;
    }
    const double steps = std::min(ahead / elapsed, mostSteps);
    // What moves less is what the camera moves around.
    const glm::dvec3 eyeStep = now.eye - before.eye, targetStep = now.target - before.target;
    const bool aroundTarget = glm::length(targetStep) <= glm::length(eyeStep);
    const auto offset = goOn(before.eye - before.target, now.eye - now.target, steps);
    if (!offset) return std::nullopt;
    Camera next = now;
    if (aroundTarget) {
        next.target = now.target + targetStep * steps;
        next.eye = next.target + *offset;
    } else {
        next.eye = now.eye + eyeStep * steps;
        next.target = next.eye - *offset;
    }
    if (before.viewHeight > 0 && now.viewHeight > 0)
        next.viewHeight =
            now.viewHeight * std::pow(std::clamp(now.viewHeight / before.viewHeight, 0.5, 2.0), steps);
    return next;
}

}  // namespace scancast
