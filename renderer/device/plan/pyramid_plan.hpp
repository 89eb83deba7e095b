// The arithmetic of docs/spec/pyramid.md §1 that is done once for a picture: how deep its pyramid goes, how
// far a block of pixels looks for neighbours, which levels have normals that somebody needs. Pure functions;
// any thread. Pipeline: pass plan → **numbers** → a device's pyramid.
#pragma once

#include <array>

#include "renderer/device/plan/screen_numbers.hpp"
#include "renderer/device/plan/stages.hpp"

namespace scancast {

/// A picture, guard band included, and where it stands in front of the eye.
struct PyramidView {
    std::int32_t width = 0, height = 0;
    bool perspective = true;
    double pixelsPerUnit = 1;  ///< f in perspective, else q
    glm::dvec2 center{0};      ///< the view axis, px from the planes' top left corner
};

/// Of planes whose first pixel is (x, y) of the picture.
PyramidView pyramidView(const Sight& sight, const glm::dvec2& jitter, int x, int y, int width, int height);

Unprojection unprojectionOf(const PyramidView& view);

struct PyramidShape {
    int levels = 0;        ///< down to one texel, and one to choose neighbourhoods by
    int widest = 0;        ///< the coarsest that a neighbourhood may use
    int normalLevels = 1;  ///< the first so many have two texels or more on each axis
    std::array<std::int32_t, maxPyramidLevels> width{}, height{};
};

PyramidShape pyramidShape(std::int32_t width, std::int32_t height);

struct HiddenPointsNumbers {
    /// By level: pixels of a block look at it unless the block's depth is larger. Falls from level to level.
    std::array<float, maxPyramidLevels> farthest{};
    float minGap = 0, threshold = 0;
    /// Up to this level, whoever lies at infinity is hidden by neighbours all around, without a look at
    /// angles.
    int sureLevel = -1;

    /// The coarsest level that a block of this depth looks at.
    int reachAt(float depth, int widest) const {
        int level = 0;
        while (level < widest && depth <= farthest[static_cast<std::size_t>(level + 1)]) ++level;
        return level;
    }
};

HiddenPointsNumbers hiddenPointsNumbers(const PyramidView& view, const HiddenPointsPass& pass);

/// Which level a pixel's normal comes from: log2 of its size, max(scaled / depth (orthographic: scaled),
/// least).
struct NormalNumbers {
    double scaled = 0;  ///< px · depth (orthographic: px)
    double least = 0;   ///< px
    int count = 1;      ///< of the levels there are
    bool perspective = true;

    /// No pixel needs a finer level; a little less, as logarithms round.
    int first() const;
    /// Nor a coarser one, where nothing is nearer than this.
    int last(float nearest) const;
};

NormalNumbers normalNumbers(const PyramidView& view, const PyramidShape& shape, const DepthNormalsPass& pass);

}  // namespace scancast
