// A second opinion on discs and ellipses: one surfel after another, one pixel after another, a ray and a
// plane in double, straight from docs/spec/surfels.md §3 and docs/spec/voronoi.md §2, sharing no code with
// any device. Slow, and meant to be obviously right.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "renderer/device/device.hpp"

namespace scancast::test {

struct ReferencePixel {
    static constexpr double none = std::numeric_limits<double>::infinity();
    double depth = none;             ///< of the nearest pass
    std::uint64_t nearest = 0;       ///< ordinal of what is there
    glm::dvec3 facing{0, 0, 1};      ///< its normal, in steps of 1/127
    double reach = 0;                ///< Ellipse: px behind it that are of its surface, in steps of an eighth
    glm::dvec2 center{0};            ///< Disc: px from here to its centre, right and up, half sizes in steps of 1/7
    double border = none;            ///< of the silhouette pass
    double distance = none;          ///< of the cell pass, cloud units
    std::uint64_t cell = 0;          ///< ordinal
    glm::dvec3 cellFacing{0, 0, 1};  ///< its normal, in steps of 1/127
    double cellDepth = none;         ///< of its surface, where that lies behind a flap
    double weight = 0;               ///< Σw
    glm::dvec3 color{0}, normal{0};  ///< Σw·rgb, Σw·n (view space)
};

struct ReferenceSurfels {
    int width = 0, height = 0;
    std::vector<ReferencePixel> pixels;
    std::vector<Rgb8> colors;  ///< by ordinal
    const ReferencePixel& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

/// The splat passes of the drawing, its first frame, coloured by rgb.
ReferenceSurfels referenceSurfels(const Drawing& drawing);

}  // namespace scancast::test
