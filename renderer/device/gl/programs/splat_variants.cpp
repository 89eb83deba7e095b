#include "renderer/device/gl/programs/splat_variants.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/device/gl/programs/splat_layouts.hpp"
#include "renderer/device/host/splats.hpp"
#include "renderer/select/fade.hpp"

namespace scancast::gl {
namespace {

#include "renderer/device/gl/shaders/splat/splat_kinds.glsl"

/// Splats of fewer px have fewer pixels than splat.comp shares out among threads.
constexpr float smallestShared = 15;
/// Threads that share out large footprints.
constexpr int sharingGroup = 128;
/// Planes of a region at most, and one turn for itself.
constexpr double turnsOfRegion = 7;
/// Pixels by which a footprint's box may be wider than its diameter: it covers those that it touches.
constexpr double boxBorder = 4;

bool isSinglePixel(const SplatPass& pass) {
    return !ofSurfels(pass) && pass.reduction != Reduction::Sum && pass.maxPx <= 1;
}
bool sharesFootprints(const SplatPass& pass) {
    return !isSinglePixel(pass) && (ofSurfels(pass) || pass.maxPx >= smallestShared);
}
/// Of a work group's tile: what fits, beside all else that its threads share, and is not so much that few groups do.
int tilePixels(const SplatPass& pass, const LayerTraits& traits) {
    constexpr std::uint32_t bounds = 256, queue = samplesPerChunk * sizeof(std::uint32_t);
    constexpr std::uint32_t mostPixels = 41 * 41, leastPixels = 64;
    const std::uint32_t bytes = traits.limits.tileBytes;
    const std::uint32_t elsewhere = bounds + (sharesFootprints(pass) ? queue : 0);
    if (pass.reduction != Reduction::Sum || bytes <= elsewhere) return 0;
    const std::uint32_t pixels = std::min((bytes - elsewhere) / (pass.sumNormals ? 28 : 16), mostPixels);
    return pixels < leastPixels ? 0 : static_cast<int>(pixels);
}
int groupSize(const SplatPass& pass, const LayerTraits& traits) {
    return sharesFootprints(pass) ? std::max(sharingGroup, traits.limits.groupSize) : traits.limits.groupSize;
}

std::uint32_t clampedSamples(double samples) {
    return static_cast<std::uint32_t>(std::clamp<double>(samples, 1, samplesPerChunk));
}

static_assert(SHAPE_FLAT_SQUARE == int(SplatShape::FlatSquare));
static_assert(SHAPE_FLAT_CIRCLE == int(SplatShape::FlatCircle));
static_assert(SHAPE_PARABOLOID_SQUARE == int(SplatShape::ParaboloidSquare));
static_assert(SHAPE_PARABOLOID_CIRCLE == int(SplatShape::ParaboloidCircle));
static_assert(SHAPE_CONE_SQUARE == int(SplatShape::ConeSquare));
static_assert(SHAPE_CONE_CIRCLE == int(SplatShape::ConeCircle));
static_assert(SHAPE_SPHERE_CIRCLE == int(SplatShape::SphereCircle));
static_assert(SHAPE_DISC == int(SplatShape::Disc) && SHAPE_ELLIPSE == int(SplatShape::Ellipse));
static_assert(COLOR_RGB == int(SplatColoring::Rgb) && COLOR_PER_RUN == int(SplatColoring::PerRun));
static_assert(COLOR_INTENSITY == int(SplatColoring::Intensity));
static_assert(COLOR_ELEVATION == int(SplatColoring::Elevation));
static_assert(COLOR_CLASSIFICATION == int(SplatColoring::Classification));
static_assert(COLOR_NORMAL == int(SplatColoring::Normal) && COLOR_DEPTH == int(SplatColoring::Depth));
static_assert(COLOR_TONED == int(SplatColoring::Toned) && COLOR_CURVATURE == int(SplatColoring::Curvature));
static_assert(COLOR_INFRARED == int(SplatColoring::Infrared));
static_assert(REDUCTION_NEAREST == int(Reduction::Nearest) && REDUCTION_CELL == int(Reduction::Cell));
static_assert(REDUCTION_SUM == int(Reduction::Sum));
static_assert(PAYLOAD_COLOR == int(SplatPayload::Color) && PAYLOAD_SAMPLE == int(SplatPayload::Sample));
static_assert(PAYLOAD_SURFACE == int(SplatPayload::Surface));
static_assert(KEEP_ORDER == int(Keep::Order) && KEEP_PAYLOAD == int(Keep::Payload));
static_assert(KEEP_KEY == int(Keep::Key) && CHUNK_SAMPLES == samplesPerChunk);

}  // namespace

ShaderVariant splatVariant(const SplatPass& pass, const LayerTraits& traits, Keep keep) {
    const bool surfels = ofSurfels(pass), sums = pass.reduction == Reduction::Sum;
    // Where only orders count, neither colours nor ordinals do.
    const bool bare = !sums && keep == Keep::Order;
    const bool colored = !bare && pass.payload == SplatPayload::Color;
    const bool tested = traits.silhouette && surfels && !pass.silhouette;
    return {"splat.comp",
            {{"GROUP_SIZE", groupSize(pass, traits)},
             {"TURN_STEP", static_cast<int>(turnStep)},
             {"REDUCTION", static_cast<int>(pass.reduction)},
             {"KEEP", static_cast<int>(keep)},
             {"KEYS64", traits.limits.keys64},
             {"LOOK_FIRST", !sums && traits.limits.lookFirst},
             {"SHAPE", static_cast<int>(pass.shape)},
             {"SINGLE_PIXEL", isSinglePixel(pass)},
             {"SHARED_FOOTPRINTS", sharesFootprints(pass)},
             {"PERSPECTIVE", pass.perspective},
             {"COLORING", colored ? static_cast<int>(pass.coloring) : 0},
             {"BY_INTENSITY", colored && pass.byIntensity},
             {"PAYLOAD", bare ? PAYLOAD_NONE : static_cast<int>(pass.payload)},
             {"SUM_NORMALS", pass.sumNormals},
             {"SUM_TILE", tilePixels(pass, traits)},
             {"SUM_SIDE", static_cast<int>(std::sqrt(tilePixels(pass, traits)))},
             {"COUNT_ADDS", sums && traits.limits.countAdds},
             {"CURVED", pass.curved && sums && pass.sumNormals && pass.shape == SplatShape::Ellipse},
             {"SILHOUETTE", tested},
             {"FILTERS", traits.filters}}};
}

std::uint32_t chunkSamples(const SplatPass& pass, const LayerTraits& traits, std::size_t pixels,
                           std::size_t regions) {
    const double loopTurns = traits.limits.loopTurns;
    if (loopTurns == 0) return samplesPerChunk;
    // What main() of splat.comp does for a sample: places it, and draws it alone, column by column within
    // rows...
    const double threads = groupSize(pass, traits);
    const double side = isSinglePixel(pass) ? 1 : pass.maxPx + boxBorder;
    const double largest = std::min(side * side, static_cast<double>(pixels));
    const double place = 1 + turnsOfRegion * static_cast<double>(regions);
    const bool shared = sharesFootprints(pass);
    const double alone = place + 2 * (shared ? std::min<double>(largest, MANY_PIXELS) : largest);
    // ... or all threads place it, and draw it together.
    const double together = shared ? place + 1 + largest / threads : 0;
    const double ofSamples = alone / threads + together;
    const double tile = tilePixels(pass, traits);
    if (tile == 0) return clampedSamples(loopTurns / ofSamples);
    // Sums look twice more where samples lie, and empty and add up a tile, plane by plane, for the whole chunk, or part by part.
    constexpr double planes = 7, leastOfPart = 32;
    const double ofTile = 2 * planes * (1 + tile / threads);
    return clampedSamples((loopTurns - ofTile) / (ofSamples + 2 * place / threads + ofTile / leastOfPart));
}

ShaderVariant resolveKeysVariant(const FramePasses& passes, bool keys64, bool normals) {
    return {"resolve_keys.comp",
            {{"KEYS64", keys64},
             {"BY_SAMPLE", passes.bySample()},
             {"CELLS", passes.cell.has_value()},
             {"NORMALS", normals}}};
}

ShaderVariant resolveSamplesVariant(const SplatPass& pass, bool keys64, bool normals, bool owners) {
    return {"resolve_samples.comp",
            {{"KEYS64", keys64},
             {"COLORING", static_cast<int>(pass.coloring)},
             {"BY_INTENSITY", pass.byIntensity},
             {"NORMALS", normals},
             {"CURVED", pass.curved && normals},
             {"OWNERS", owners}}};
}

ShaderVariant resolveSumsVariant(const FramePasses& passes, bool keys64, bool normals) {
    return {"resolve_sums.comp",
            {{"KEYS64", keys64}, {"SUM_NORMALS", passes.sum->normals}, {"NORMALS", normals}}};
}

}  // namespace scancast::gl
