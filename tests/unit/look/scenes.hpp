// Surveys of scenes made up for tests, whose kind and sides are known: a ground, a room, a thing, a camera's frame.
#pragma once

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <vector>

#include "renderer/look/survey.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

/// A number in [low, high) that depends on `i` and `stream` alone.
inline double between(double low, double high, std::uint64_t i, std::uint64_t stream) {
    return low + (high - low) * uniform(i, stream);
}

using MakePoint = std::function<SurveyPoint(std::uint64_t i)>;

inline std::vector<SurveyPoint> surveyOf(std::uint64_t count, const MakePoint& make) {
    std::vector<SurveyPoint> points;
    for (std::uint64_t i = 0; i < count; ++i) points.push_back(make(i));
    return points;
}

inline SurveyPoint pointAt(const glm::dvec3& position, const glm::vec3& normal = glm::vec3(0)) {
    return {.position = position, .normal = normal, .spacing = 0.01f, .classification = 0};
}

inline void append(std::vector<SurveyPoint>& to, const std::vector<SurveyPoint>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

/// A ball's surface.
inline std::vector<SurveyPoint> blob(std::uint64_t count, const glm::dvec3& center, double radius) {
    return surveyOf(count, [&](std::uint64_t i) {
        const ScanPoint p = ball(i, count);
        return pointAt(center + p.position * (radius / 10), p.normal);
    });
}

/// A rolling landscape of 1000 × 1000 with heights in this range.
inline std::vector<SurveyPoint> landscape(std::uint64_t count, const glm::dvec2& corner, double low,
                                          double high) {
    return surveyOf(count, [&](std::uint64_t i) {
        const double x = between(0, 1000, i, 1), y = between(0, 1000, i, 2);
        const double height = (std::sin(x * 0.011) * std::cos(y * 0.007) + 1) / 2;
        return pointAt({corner.x + x, corner.y + y, low + (high - low) * height}, {0, 0, 1});
    });
}

/// What a camera at the origin saw of a wall with a pillar before it: looking along +z with y down (`sign` 1),
/// or along -z with y up (-1).
inline std::vector<SurveyPoint> depthFrame(std::uint64_t count, double sign) {
    return surveyOf(count, [&](std::uint64_t i) {
        const double u = between(-0.6, 0.6, i, 1), v = between(-0.45, 0.45, i, 2);
        const double depth = std::abs(u - 0.1) < 0.08 ? 1.5 : 3 + 0.5 * u;
        return pointAt({u * depth, v * depth, sign * depth}, {0, 0, float(-sign)});
    });
}

/// Facts of the kind that a reader of models or of surveys tells.
inline CloudFacts factsOf(const std::vector<SurveyPoint>& points, const std::string& format) {
    CloudFacts facts;
    facts.format = format;
    facts.points = points.size();
    facts.bounds = boxOf(points);
    facts.surfels = true;
    return facts;
}

}  // namespace scancast::test
