#include "renderer/device/gl/programs/splat_variants.hpp"

#include <algorithm>
#include <set>

#include "renderer/device/gl/programs/splat_layouts.hpp"
#include "renderer/device/plan/splat_plan.hpp"
#include "renderer/select/fade.hpp"

namespace scancast::gl {
namespace {

#include "renderer/device/gl/shaders/splat/splat_kinds.glsl"

/// Splats of fewer px have fewer pixels than splat.comp shares out among threads.
constexpr float smallestShared = 15;
/// Threads that share out large footprints.
constexpr int sharingGroup = 128;
/// Planes of a dropped region at most, and one turn for itself.
constexpr double turnsOfRegion = 6;
/// Pixels by which a footprint's box may be wider than its diameter: it covers those that it touches.
constexpr double boxBorder = 4;

bool isSinglePixel(const SplatStage& stage) {
    return !ofSurfels(stage.splat) && stage.numbers.reduction != Reduction::Sum && stage.numbers.maxPx <= 1;
}
bool sharesFootprints(const SplatStage& stage) {
    return !isSinglePixel(stage) && (ofSurfels(stage.splat) || stage.numbers.maxPx >= smallestShared);
}
int groupSize(const SplatStage& stage, const LayerTraits& traits) {
    return sharesFootprints(stage) ? std::max(sharingGroup, traits.limits.groupSize)
                                   : traits.limits.groupSize;
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
static_assert(REDUCTION_NEAREST == int(Reduction::Nearest) && REDUCTION_CELL == int(Reduction::Cell));
static_assert(REDUCTION_SUM == int(Reduction::Sum));
static_assert(KEEP_ORDER == int(Keep::Order) && KEEP_PAYLOAD == int(Keep::Payload));
static_assert(KEEP_KEY == int(Keep::Key) && CHUNK_SAMPLES == samplesPerChunk);

}  // namespace

ShaderVariant splatVariant(const SplatStage& stage, const LayerTraits& traits, Keep keep) {
    const SplatNumbers& n = stage.numbers;
    const bool surfels = ofSurfels(stage.splat), sums = n.reduction == Reduction::Sum;
    // Where only orders count, neither colours nor ordinals do.
    const bool bare = !sums && keep == Keep::Order;
    const bool colored = !bare && !n.payloadSample;
    const bool tested = traits.silhouette && surfels && stage.kind != SplatStage::Kind::Silhouette;
    return {"splat.comp",
            {{"GROUP_SIZE", groupSize(stage, traits)},
             {"TURN_STEP", static_cast<int>(turnStep)},
             {"REDUCTION", static_cast<int>(n.reduction)},
             {"KEEP", static_cast<int>(keep)},
             {"KEYS64", traits.limits.keys64},
             {"LOOK_FIRST", !sums && traits.limits.lookFirst},
             {"SHAPE", static_cast<int>(n.shape)},
             {"SINGLE_PIXEL", isSinglePixel(stage)},
             {"SHARED_FOOTPRINTS", sharesFootprints(stage)},
             {"PERSPECTIVE", n.perspective},
             {"COLORING", colored ? static_cast<int>(n.coloring) : 0},
             {"PAYLOAD_SAMPLE", n.payloadSample && !bare},
             {"SUM_NORMALS", n.sumNormals},
             {"SILHOUETTE", tested},
             {"FILTERS", traits.filters}}};
}

std::uint32_t chunkSamples(const SplatStage& stage, const LayerTraits& traits, std::size_t pixels,
                           std::size_t regions) {
    const double loopTurns = traits.limits.loopTurns;
    if (loopTurns == 0) return samplesPerChunk;
    // What main() of splat.comp does for a sample: places it, and draws it alone, column by column within
    // rows...
    const double threads = groupSize(stage, traits);
    const double side = isSinglePixel(stage) ? 1 : stage.numbers.maxPx + boxBorder;
    const double largest = std::min(side * side, static_cast<double>(pixels));
    const double place = 1 + turnsOfRegion * static_cast<double>(regions);
    const bool shared = sharesFootprints(stage);
    const double alone = place + 2 * (shared ? std::min<double>(largest, MANY_PIXELS) : largest);
    // ... or all threads place it, and draw it together.
    const double together = shared ? place + 1 + largest / threads : 0;
    const double samples = loopTurns / (alone / threads + together);
    return static_cast<std::uint32_t>(std::clamp<double>(samples, 1, samplesPerChunk));
}

ShaderVariant resolveKeysVariant(const PassPlan& plan, bool keys64, bool normals) {
    return {"resolve_keys.comp",
            {{"KEYS64", keys64},
             {"BY_SAMPLE", plan.bySample()},
             {"CELLS", plan.cell.has_value()},
             {"NORMALS", normals}}};
}

ShaderVariant resolveSamplesVariant(SplatColoring coloring, bool keys64, bool normals) {
    return {"resolve_samples.comp",
            {{"KEYS64", keys64}, {"COLORING", static_cast<int>(coloring)}, {"NORMALS", normals}}};
}

ShaderVariant resolveSumsVariant(const PassPlan& plan, bool keys64, bool normals) {
    return {"resolve_sums.comp",
            {{"KEYS64", keys64}, {"SUM_NORMALS", plan.sum->normals}, {"NORMALS", normals}}};
}

namespace {

constexpr SplatColoring colorings[] = {
    SplatColoring::Rgb,       SplatColoring::PerRun,         SplatColoring::Intensity,
    SplatColoring::Elevation, SplatColoring::Classification, SplatColoring::Normal,
    SplatColoring::Depth};

/// Collects variants, each once.
class Variants {
  public:
    void add(ShaderVariant variant) {
        std::string name(variant.shader);
        for (const Define& define : variant.defines) name.append(" ").append(std::to_string(define.value));
        if (known_.insert(name).second) all_.push_back(std::move(variant));
    }
    std::vector<ShaderVariant> all() && { return std::move(all_); }

  private:
    std::set<std::string> known_;
    std::vector<ShaderVariant> all_;
};

/// In both projections, with and without filters and a silhouette, keys whole and in halves.
void addStage(SplatStage stage, bool silhouettes, Variants& variants) {
    for (const bool perspective : {false, true}) {
        stage.numbers.perspective = perspective;
        for (const bool filters : {false, true}) {
            for (const bool silhouette : {false, true}) {
                if (silhouette && !silhouettes) continue;
                // Keys in halves, with and without a look; whole keys, with silhouettes that are orders
                // alone.
                for (const bool lookFirst : {false, true}) {
                    const LayerTraits halves{{.lookFirst = lookFirst}, filters, silhouette};
                    for (const Keep keep : {Keep::Order, Keep::Payload})
                        variants.add(splatVariant(stage, halves, keep));
                }
                const LayerTraits whole{{.keys64 = true}, filters, silhouette};
                for (const Keep keep : {Keep::Key, Keep::Order})
                    variants.add(splatVariant(stage, whole, keep));
            }
        }
    }
}

/// A stage of every colouring that its payload or its sums can have.
void addColorings(SplatStage stage, bool silhouettes, Variants& variants) {
    for (const SplatColoring coloring : colorings) {
        stage.numbers.coloring = coloring;
        addStage(stage, silhouettes, variants);
    }
}

SplatStage stageOf(SplatStage::Kind kind, Footprint footprint, Profile profile, float maxPx) {
    SplatStage stage;
    stage.kind = kind;
    stage.splat.footprint = footprint;
    stage.splat.profile = profile;
    stage.numbers.shape = splatShape(footprint, profile);
    stage.numbers.maxPx = maxPx;
    return stage;
}

void addSprites(Variants& variants) {
    using enum Profile;
    for (const Footprint footprint : {Footprint::Square, Footprint::Circle}) {
        for (const Profile profile : {Flat, Paraboloid, Cone, Sphere}) {
            for (const float maxPx : {1.0f, 5.0f, 50.0f}) {
                SplatStage stage = stageOf(SplatStage::Kind::Nearest, footprint, profile, maxPx);
                addColorings(stage, false, variants);
                stage.numbers.payloadSample = true;
                addStage(stage, false, variants);
            }
        }
    }
}

void addSums(Footprint footprint, bool silhouettes, Variants& variants) {
    for (const float maxPx : {5.0f, 50.0f}) {
        SplatStage stage = stageOf(SplatStage::Kind::Sum, footprint, Profile::Flat, maxPx);
        stage.numbers.reduction = Reduction::Sum;
        for (const bool normals : {false, true}) {
            stage.numbers.sumNormals = normals;
            addColorings(stage, silhouettes, variants);
        }
    }
}

void addSurfels(Variants& variants) {
    for (const Footprint footprint : {Footprint::Disc, Footprint::Ellipse}) {
        SplatStage stage = stageOf(SplatStage::Kind::Nearest, footprint, Profile::Flat, 256);
        addColorings(stage, true, variants);
        stage.numbers.payloadSample = true;
        addStage(stage, true, variants);
        addSums(footprint, true, variants);
    }
    SplatStage cell = stageOf(SplatStage::Kind::Cell, Footprint::Disc, Profile::Flat, 256);
    cell.numbers.reduction = Reduction::Cell;
    cell.numbers.payloadSample = true;
    addStage(cell, true, variants);
}

void addResolves(bool keys64, bool normals, Variants& variants) {
    PassPlan plan;
    for (const Payload payload : {Payload::Color, Payload::Sample}) {
        plan.nearest.payload = payload;
        variants.add(resolveKeysVariant(plan, keys64, normals));
    }
    plan.cell.emplace();
    variants.add(resolveKeysVariant(plan, keys64, normals));
    for (const SplatColoring coloring : colorings)
        variants.add(resolveSamplesVariant(coloring, keys64, normals));
    plan.sum.emplace().normals = normals;
    variants.add(resolveSumsVariant(plan, keys64, normals));
}

}  // namespace

std::vector<ShaderVariant> allSplatVariants() {
    Variants variants;
    addSprites(variants);
    addSums(Footprint::Circle, false, variants);
    addSurfels(variants);
    for (const bool keys64 : {false, true}) {
        for (const bool normals : {false, true}) addResolves(keys64, normals, variants);
    }
    return std::move(variants).all();
}

}  // namespace scancast::gl
