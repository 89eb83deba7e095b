// How a scene may be coloured and lit, what suits it best first. Pipeline: scene → **styles** → look.
#pragma once

#include <string>
#include <vector>

#include "renderer/look/surveyed_scene.hpp"

namespace scancast {

struct StyleChoice {
    Style style;
    std::string reason;    ///< a sentence
    bool sidelit = false;  ///< its light comes from beside the first camera, once that is known
};

/// At least one, and one that every cloud can be drawn in.
std::vector<StyleChoice> stylesFor(const CloudFacts& facts, const SurveyedScene& scene);

/// The light that shows relief on one colour: a sun that grazes it, from the upper left of who sees it first. It stays
/// there, as over a statue that one walks around. `up`: of the scene, unit vector.
LightRig sidelight(const Camera& first, const glm::dvec3& up);

}  // namespace scancast
