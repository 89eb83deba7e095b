// From where a scene may be looked at: places around it and, where people were inside, places within, at eye
// height over free floor. Pipeline: scene → **candidates** → look.
#pragma once

#include <string>
#include <vector>

#include "renderer/look/surveyed_scene.hpp"

namespace scancast {

struct Candidate {
    LookView view;
    double bonus = 0;  ///< what people are used to: a little from above, not from behind
};

/// Around the scene, fitted to the outline; above it, too.
std::vector<Candidate> outsideCandidates(const SurveyedScene& scene, const std::vector<glm::dvec3>& outline);

/// Where the scanner or camera stood, if that is known, else on free floor; none where there is no room.
std::vector<Candidate> insideCandidates(const SurveyedScene& scene);

/// Outermost points in all directions, without the last few in each; at most Look::mostOutline.
std::vector<glm::dvec3> outlineOf(const std::vector<SurveyPoint>& points);

}  // namespace scancast
