#include "renderer/look/choose_style.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "renderer/method/light.hpp"

namespace scancast {

namespace {

/// A calm warm grey: shape shows by light alone.
constexpr Rgb8 clay{206, 196, 182};

struct Choices {
    std::vector<StyleChoice> all;

    Style& add(ColorSource color, Shading shading, std::string reason) {
        StyleChoice& choice = all.emplace_back();
        choice.style.method = "auto";
        choice.style.color = color;
        choice.style.shading = shading;
        choice.reason = std::move(reason);
        return choice.style;
    }
};

using Range = std::optional<std::array<double, 2>>;

/// A style has no range of no width: the cloud's own is as good then.
Range rangeOf(double low, double high) {
    return low < high ? Range({low, high}) : std::nullopt;
}

Range intensityRange(const CloudFacts& facts) {
    if (!facts.usual) return rangeOf(facts.intensityRange[0], facts.intensityRange[1]);
    return rangeOf(facts.usual->intensity[0], facts.usual->intensity[1]);
}

Range elevationRange(const SurveyedScene& scene) {
    std::vector<double> heights;
    for (const SurveyPoint& p : scene.points) heights.push_back(p.position.z);
    const double low = quantileOf(heights, 0.01);
    return rangeOf(low, quantileOf(std::move(heights), 0.99));
}

/// ASPRS classes that people know on sight: ground, plants, buildings, water, rails, roads, wires, bridges.
constexpr std::array<std::uint8_t, 13> knownClasses{2, 3, 4, 5, 6, 9, 10, 11, 13, 14, 15, 16, 17};

/// Whether most points have one of these classes, and not nearly all the same.
bool hasTellingClasses(const CloudFacts& facts) {
    if (!facts.attributes.classification) return false;
    std::uint64_t most = 0, known = 0;
    for (const std::uint8_t c : knownClasses) {
        most = std::max(most, facts.classCounts[c]);
        known += facts.classCounts[c];
    }
    return 4 * known > 3 * facts.points && 4 * most < 3 * facts.points;
}

/// Photographs: as they are, or with whatever makes them readable.
void addPhotographed(const CloudFacts& facts, bool lit, Choices& choices) {
    using enum ColorSource;
    choices.add(Rgb, Shading::Unlit, "It has photographed colours.");
    choices.add(Rgb, Shading::EyeDome, "It has photographed colours; edges are made clear.");
    if (facts.attributes.intensity)
        choices.add(Rgb, Shading::EyeDome, "It has photographed colours; intensity gives them texture.")
            .byIntensity = true;
    if (lit)
        choices.add(Rgb, Shading::Phong,
                    "It has photographed colours, but pale ones: light shows the shape.");
}

/// Colours that tell heights or classes, brighter where the ground reflects more.
void addLand(const CloudFacts& facts, const SurveyedScene& scene, Choices& choices) {
    using enum ColorSource;
    if (hasTellingClasses(facts))
        choices
            .add(Classification, Shading::EyeDome,
                 "It has no colours, but classes that tell ground, plants and buildings apart.")
            .byIntensity = facts.attributes.intensity;
    Style& style = choices.add(Elevation, Shading::EyeDome, "It has no colours: they show height.");
    style.range = elevationRange(scene);
    style.byIntensity = facts.attributes.intensity;
    if (facts.attributes.intensity)
        choices.add(Elevation, Shading::EyeDome, "It has no colours: they show height.").range =
            elevationRange(scene);
}

/// No length means anything where axes have different units: sizes are given in pixels.
void addMap(const CloudFacts& facts, const SurveyedScene& scene, Choices& choices) {
    Style& style = choices.add(
        facts.attributes.color ? ColorSource::Rgb : ColorSource::Elevation, Shading::Unlit,
        facts.attributes.color ? "It has photographed colours." : "It has no colours: they show height.");
    if (!facts.attributes.color) style.range = elevationRange(scene);
    style.method = "paraboloid";
    constexpr double pixels = 1280 * 720 * 0.5;
    style.parameters["sizePx"] =
        std::clamp(std::round(1.5 * std::sqrt(pixels / double(facts.points))), 1.0, 24.0);
}

/// Light on clay, reflected light, height: in this order, objects; else reflected light first.
void addShape(const CloudFacts& facts, const SurveyedScene& scene, bool lit, Choices& choices) {
    using enum ColorSource;
    const bool isObject = scene.kind == SceneKind::Object || scene.kind == SceneKind::DepthFrame;
    const auto addClay = [&] {
        if (!lit) return;
        Style& style = choices.add(Flat, Shading::Phong, "It has no colours: light shows the shape.");
        style.flatColor = clay;
        choices.all.back().sidelit = true;
    };
    if (isObject) addClay();
    if (facts.attributes.intensity) {
        Style& style = choices.add(Intensity, Shading::EyeDome,
                                   "It has no colours: how strongly it reflects is shown as grey.");
        style.colormap = "grey";
        style.range = intensityRange(facts);
    }
    if (!isObject) addClay();
    // What is flat looks the same all over in any light.
    choices.add(Elevation, Shading::EyeDome, "It has no colours: they show height.").range =
        elevationRange(scene);
}

}  // namespace

std::vector<StyleChoice> stylesFor(const CloudFacts& facts, const SurveyedScene& scene) {
    Choices choices;
    if (scene.onlyFromAbove) {
        addMap(facts, scene, choices);
        return std::move(choices.all);
    }
    const bool lit = facts.surfels || facts.attributes.normal;
    if (facts.attributes.color)
        addPhotographed(facts, lit, choices);
    else if (scene.kind == SceneKind::Airborne)
        addLand(facts, scene, choices);
    else
        addShape(facts, scene, lit, choices);
    return std::move(choices.all);
}

LightRig sidelight(const Camera& first, const glm::dvec3& up) {
    constexpr double left = 0.7, above = 0.5, behind = 0.5;  // of the way from what is seen to the sun
    constexpr double lowest = 10;                            // degrees
    const glm::dvec3 back = glm::normalize(first.eye - first.target);
    const glm::dvec3 right = glm::normalize(glm::cross(first.up, back));
    LightRig light;
    light.ambient = 0.2;
    light.headlight = 0.25;
    light.sunlight = 0.55;
    light.sun = sunAlong(back * behind - right * left + glm::cross(back, right) * above, up);
    light.sun->at(1) = std::max(light.sun->at(1), lowest);
    // What is photographed has its own; points that stand singly would show their outlines by it, surfels do not.
    light.occlusion = 0.6;
    return light;
}

}  // namespace scancast
