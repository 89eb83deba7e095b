// docs/spec/pyramid.md §3 to §6, word by word, in double, pixel by pixel: slow, and obviously what the page
// says. Shares no code with the kernels.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "renderer/device/pass.hpp"
#include "tests/support/pictures/point_screen.hpp"

namespace scancast::test {

/// Mean occlusion of a pixel by its neighbours, or 1 where no sector counts.
struct ReferenceHidden {
    std::vector<double> occlusion;
    std::vector<std::uint8_t> labels;
};

ReferenceHidden referenceHidden(const PointScreen& screen, const HiddenPointsPass& pass);

/// Filled colour and depth of every level; [0] is the picture.
struct ReferenceFilled {
    struct Level {
        int width = 0, height = 0;
        std::vector<double> depth;  ///< +infinity = unknown
        std::vector<glm::dvec3> color;
        std::size_t at(int x, int y) const;  ///< clamped to the level
    };
    std::vector<Level> levels;
};

/// `screen` as it was before filling, with its labels.
ReferenceFilled referenceFilled(const PointScreen& screen);

/// Of the pixels of `filled` that are not background; (0, 0, 0) there.
std::vector<glm::dvec3> referenceNormals(const PointScreen& screen, const ReferenceFilled& filled,
                                         const DepthNormalsPass& pass);

}  // namespace scancast::test
