// How a scene may be coloured and lit, what suits it best first. Pipeline: scene → **styles** → look.
#pragma once

#include <string>
#include <vector>

#include "renderer/look/surveyed_scene.hpp"

namespace scancast {

struct StyleChoice {
    Style style;
    std::string reason;  ///< a sentence
};

/// At least one, and one that every cloud can be drawn in.
std::vector<StyleChoice> stylesFor(const CloudFacts& facts, const SurveyedScene& scene);

}  // namespace scancast
