// From splat passes and runs of a cut to their numbers: the host's arithmetic that devices share, so that it
// cannot drift apart. Node → view → picture is composed in double, so that no large coordinate reaches a float
// sum; clip box and regions are in the integers of a run's samples. Pure functions; any thread.
// Pipeline: passes, cut → **numbers** → device.
#pragma once

#include <optional>
#include <vector>

#include "renderer/device/host/drawing.hpp"
#include "renderer/device/host/splat_numbers.hpp"

namespace scancast {

/// Beyond these, floats of kernels and shaders could overflow; nothing real is that large.
inline constexpr double largestCoefficient = 1e24;
inline constexpr float farthestDepth = 1e30f;

/// Footprint::Pixel counts as a square; spheres are not defined outside their circle (docs/spec/sprites.md
/// §3).
SplatShape splatShape(Footprint footprint, Profile profile);

/// Whether its splats lie in their surfels' planes.
inline bool ofSurfels(const SplatPass& pass) {
    return pass.shape == SplatShape::Disc || pass.shape == SplatShape::Ellipse;
}

/// "silhouette", "nearest", "sum", "cell": what a frame's times call it.
const char* nameOf(const SplatPass& pass);

/// The splat passes of a frame, in their order. Jitter is left out: it only moves centerX and centerY.
std::vector<SplatPass> splatPasses(const FramePasses& passes, const LayerView& view, const ColorRule& color);

/// The pass in one jittered frame. Added in double, as everything that places samples is.
SplatPass jittered(SplatPass pass, const LayerView& view, const glm::dvec2& jitter);

/// RunNumbers::toPicture of samples that count in steps from a corner. False: something is too large for a float.
bool composeToPicture(const glm::dvec3& corner, const glm::dvec3& step, const glm::dmat4& cloudToView,
                      double pixelsPerUnit, float (&rows)[3][4]);

/// What stays as long as the cut does, wherever it is seen from: everything but toPicture. nullopt: nothing of the run
/// can be drawn.
std::optional<RunNumbers> runFacts(const CutRun& run, const LayerView& view, const ColorRule& color,
                                   const SampleFilter& filter);

/// All of it. nullopt: nothing of the run can be drawn.
std::optional<RunNumbers> runNumbers(const CutRun& run, const LayerView& view, const ColorRule& color,
                                     const SampleFilter& filter);

/// Those that cross a node, with the planes that do: a sample is drawn if it lies in none of those in which samples are
/// dropped, which come first, and in one at least of the others, where there are any.
struct RunRegions {
    std::vector<RunRegion> regions;
    std::int32_t dropped = 0, kept = 0;
};

/// What is to be asked of each sample of a node, by shapes and mirrors: nothing of nodes that none of their faces crosses.
/// nullopt: nothing of it is drawn.
std::optional<RunRegions> runRegions(const Node& node, const SampleFilter& filter);

/// p = clamp(factor · ratio (/ d in perspective), minPx, maxPx) of the run's sprites.
inline double spriteFactor(float plainRadius, float scale, double pixelsPerUnit) {
    return 2.0 * plainRadius * scale * pixelsPerUnit;
}

}  // namespace scancast
