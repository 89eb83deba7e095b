// The arithmetic of screen passes that is done once for a picture: how it is lit (docs/spec/shading.md); how deep
// its pyramid goes, how far a block of pixels looks for neighbours, which levels have normals that somebody needs
// (docs/spec/pyramid.md §1); where a mirror's glass is seen (docs/spec/mirrors.md §3). Pure functions; any thread.
// Pipeline: passes, reflections → **numbers** → a device's screen passes and mirrors.
#pragma once

#include <array>

#include "renderer/device/host/drawing.hpp"
#include "renderer/device/host/screen_numbers.hpp"

namespace scancast {

// ---- lighting

/// For planes whose first pixel is (x, y) of the picture, guard band included.
PhongNumbers phongNumbers(const PhongPass& pass, const LayerView& view, const glm::dvec2& jitter, int x,
                          int y);

/// The eight neighbours at the pass's radius, and shade = exp(-300 · strength · mean response) of
/// docs/spec/shading.md §3.
EyeDomeNumbers eyeDomeNumbers(const EyeDomePass& pass);

/// The widest ring may be so wide, px; in one jittered frame each is larger or smaller by up to a fifth.
inline constexpr double widestOcclusion = 64;
int occlusionReach(const OcclusionPass& pass);
/// docs/spec/shading.md §9. Each frame of an average looks in other directions.
OcclusionNumbers occlusionNumbers(const OcclusionPass& pass, const LayerView& view, const glm::dvec2& jitter);

/// For planes whose first pixel is (x, y) of the picture, guard band included; `sun` sees the map.
ShadowNumbers shadowNumbers(const ShadowPass& pass, const LayerView& view, const Viewpoint& sun,
                            const glm::dvec2& jitter, int x, int y);

// ---- the pyramid

/// A picture, guard band included, and where it stands in front of the eye.
struct PyramidView {
    std::int32_t width = 0, height = 0;
    bool perspective = true;
    double pixelsPerUnit = 1;  ///< f in perspective, else q
    glm::dvec2 center{0};      ///< the view axis, px from the planes' top left corner
};

/// Of planes whose first pixel is (x, y) of the picture.
PyramidView pyramidView(const LayerView& view, const glm::dvec2& jitter, int x, int y, int width, int height);

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
    /// Up to this level, a pixel without a sample that has neighbours on all sides is hidden for certain:
    /// angles need no look.
    int sureLevel = -1;
    ClosingSize closing;
    bool perspective = true;

    /// Of the background of a block of this depth.
    std::int32_t closingAt(float depth) const;
    /// The coarsest level that a block of this depth looks at.
    int reachAt(float depth, int widest) const {
        int level = 0;
        while (level < widest && depth <= farthest[static_cast<std::size_t>(level + 1)]) ++level;
        return level;
    }
};

HiddenPointsNumbers hiddenPointsNumbers(const PyramidView& view, const HiddenPointsPass& pass);

/// Of VisibilityPass, as planes have colours.
struct VisibilityColors {
    std::uint32_t foreground = 0, hidden = 0, hole = 0;
};

VisibilityColors visibilityColors(const VisibilityPass& pass);

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

// ---- glass

/// In one jittered frame of the picture; `view` is the main one, or that of the reflected eye.
GlassNumbers glassNumbers(const MirrorGlass& glass, const LayerView& view, const glm::dvec2& jitter);

}  // namespace scancast
