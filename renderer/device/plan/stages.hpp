// From a list of passes to the numbers of each splat pass. Pure functions; any thread. Pipeline: pass plan →
// **stages** → device.
#pragma once

#include <vector>

#include "renderer/device/device.hpp"
#include "renderer/device/plan/pass_plan.hpp"
#include "renderer/device/plan/splat_numbers.hpp"

namespace scancast {

/// What a picture, or its reflection in a mirror, is seen with.
struct Sight {
    const Viewpoint* viewpoint = nullptr;
    int pad = 0;            ///< rows and columns that every coordinate is shifted by, for a guard band
    bool surfels = false;   ///< samples carry radii, ellipses and normals
    bool oriented = false;  ///< a normal's sign means something
    /// The view axis, px, before jitter.
    glm::dvec2 center() const { return {viewpoint->width * 0.5 + pad, viewpoint->height * 0.5 + pad}; }
    bool perspective() const { return viewpoint->projection == Projection::Perspective; }
};

/// One splat pass of a list, with its numbers.
struct SplatStage {
    enum class Kind : std::uint8_t { Silhouette, Nearest, Sum, Cell };
    Kind kind = Kind::Nearest;
    Splat splat;
    SplatNumbers numbers;
};
inline constexpr std::size_t mostSplatStages = 4;

/// The splat passes of a plan, in their order. Jitter is left out: it only moves centerX and centerY.
std::vector<SplatStage> splatStages(const PassPlan& plan, const Sight& sight, const ColorRule& color);

/// The stage's numbers in one jittered frame. Added in double, as everything that places samples is.
SplatNumbers jittered(const SplatNumbers& numbers, const Sight& sight, const glm::dvec2& jitter);

}  // namespace scancast
