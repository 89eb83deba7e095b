// Surfels that a test makes itself, and drawings of them with any list of passes, everything else at its
// plainest.
#pragma once

#include <glm/geometric.hpp>

#include "renderer/cloud/surfel_codec.hpp"
#include "tests/support/pictures/draw_cut.hpp"

namespace scancast::test {

inline Surfel surfelOf(glm::dvec3 normal, double radius, glm::dvec3 majorAxis = {0, 0, 0}, double ratio = 1) {
    Surfel s;
    s.normal = glm::normalize(glm::vec3(normal));
    s.majorAxis = glm::vec3(majorAxis);
    s.radius = static_cast<float>(radius);
    s.major = majorPerRadius * s.radius;
    s.minor = static_cast<float>(ratio) * s.major;
    return s;
}

/// A drawing that owns its pass list.
struct SurfelScene {
    PassList passes;
    OwnDrawing drawing;

    SurfelScene(const Viewpoint& viewpoint, const Cut& cut, PassList list)
        : passes(std::move(list)), drawing(viewpoint, cut, passes) {
        drawing.surfels = true;
        for (const CutRun& run : cut.runs) drawing.curvatures |= !run.beside.empty();
        drawing.background.kind = Background::Kind::Color;
        drawing.background.top = {0, 0, 0};
    }
    SurfelScene(const SurfelScene&) = delete;
};

}  // namespace scancast::test
