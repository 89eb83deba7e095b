// What kind of scene a cloud shows and which way is up, told from its points: where floors, walls and ceilings
// are, whether everything was seen from one place, how broadly it stands. Pipeline: survey → **scene** → look.
#pragma once

#include <optional>
#include <string>

#include "protocol/look.hpp"
#include "renderer/look/survey.hpp"

namespace scancast {

struct SurveyedScene {
    SceneKind kind = SceneKind::Object;
    glm::dvec3 up{0, 0, 1};
    std::string reason;                ///< sentences
    std::vector<SurveyPoint> points;   ///< without strays
    std::array<glm::dvec3, 2> box{};   ///< of the points, file coordinates
    std::optional<glm::dvec3> sensor;  ///< where the scanner or camera stood
    glm::dvec3 forward{0, 0, 1};       ///< DepthFrame: where the camera looked, unit vector
    bool onlyFromAbove = false;        ///< heights are in another unit than the ground: degrees and metres

    glm::dvec3 center() const { return (box[0] + box[1]) * 0.5; }
    glm::dvec3 size() const { return box[1] - box[0]; }
    /// Length of the box's diagonal; > 0.
    double extent() const;
};

/// Two horizontal axes, so that (first, second, up) is right-handed.
std::array<glm::dvec3, 2> horizontalAxes(const glm::dvec3& up);

/// `points` is not empty.
SurveyedScene sceneOf(const CloudFacts& facts, std::vector<SurveyPoint> points);

}  // namespace scancast
