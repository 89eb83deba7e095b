#include "tests/unit/gl/every_splat_variant.hpp"

#include <set>

#include "renderer/device/host/splats.hpp"

namespace scancast::gl {
namespace {

constexpr SplatColoring colorings[] = {
    SplatColoring::Rgb,       SplatColoring::PerRun,         SplatColoring::Intensity,
    SplatColoring::Elevation, SplatColoring::Classification, SplatColoring::Normal,
    SplatColoring::Depth,     SplatColoring::Toned,          SplatColoring::Curvature,
    SplatColoring::Infrared};

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
void addPass(SplatPass pass, bool silhouettes, Variants& variants) {
    for (const bool perspective : {false, true}) {
        pass.perspective = perspective;
        for (const bool filters : {false, true}) {
            for (const bool silhouette : {false, true}) {
                if (silhouette && !silhouettes) continue;
                // Keys in halves, with and without a look; whole keys, with silhouettes that are orders
                // alone.
                for (const bool lookFirst : {false, true}) {
                    const LayerTraits halves{{.lookFirst = lookFirst}, filters, silhouette};
                    for (const Keep keep : {Keep::Order, Keep::Payload})
                        variants.add(splatVariant(pass, halves, keep));
                }
                const LayerTraits whole{{.keys64 = true}, filters, silhouette};
                for (const Keep keep : {Keep::Key, Keep::Order})
                    variants.add(splatVariant(pass, whole, keep));
                // Tiles know nothing of where colours come from.
                if (pass.reduction != Reduction::Sum || pass.coloring != SplatColoring::Rgb) continue;
                for (const bool keys64 : {false, true}) {
                    const LayerTraits tiles{{.keys64 = keys64, .tileBytes = 49152}, filters, silhouette};
                    variants.add(splatVariant(pass, tiles, Keep::Order));
                }
            }
        }
    }
}

/// A pass of every colouring that its payload or its sums can have; what intensity does to it is the same for all.
void addColorings(SplatPass pass, bool silhouettes, Variants& variants) {
    for (const SplatColoring coloring : colorings) {
        pass.coloring = coloring;
        addPass(pass, silhouettes, variants);
    }
    pass.byIntensity = true;
    addPass(pass, silhouettes, variants);
}

SplatPass passOf(Reduction reduction, Footprint footprint, Profile profile, float maxPx) {
    SplatPass pass;
    pass.reduction = reduction;
    pass.shape = splatShape(footprint, profile);
    pass.maxPx = maxPx;
    return pass;
}

void addSprites(Variants& variants) {
    using enum Profile;
    for (const Footprint footprint : {Footprint::Square, Footprint::Circle}) {
        for (const Profile profile : {Flat, Paraboloid, Cone, Sphere}) {
            for (const float maxPx : {1.0f, 5.0f, 50.0f}) {
                SplatPass pass = passOf(Reduction::Nearest, footprint, profile, maxPx);
                addColorings(pass, false, variants);
                for (const SplatPayload payload : {SplatPayload::Sample, SplatPayload::Surface}) {
                    pass.payload = payload;
                    addPass(pass, false, variants);
                }
            }
        }
    }
}

void addSums(Footprint footprint, bool silhouettes, Variants& variants) {
    for (const float maxPx : {5.0f, 50.0f}) {
        SplatPass pass = passOf(Reduction::Sum, footprint, Profile::Flat, maxPx);
        for (const bool normals : {false, true}) {
            pass.sumNormals = normals;
            addColorings(pass, silhouettes, variants);
        }
        if (footprint != Footprint::Ellipse) continue;
        pass.curved = true;
        addPass(pass, silhouettes, variants);
    }
}

void addSurfels(Variants& variants) {
    for (const Footprint footprint : {Footprint::Disc, Footprint::Ellipse}) {
        SplatPass pass = passOf(Reduction::Nearest, footprint, Profile::Flat, 256);
        addColorings(pass, true, variants);
        for (const SplatPayload payload : {SplatPayload::Sample, SplatPayload::Surface}) {
            pass.payload = payload;
            addPass(pass, true, variants);
        }
        addSums(footprint, true, variants);
    }
    SplatPass cell = passOf(Reduction::Cell, Footprint::Disc, Profile::Flat, 256);
    cell.payload = SplatPayload::Sample;
    addPass(cell, true, variants);
}

void addResolves(bool keys64, bool normals, Variants& variants) {
    FramePasses passes;
    for (const Payload payload : {Payload::Color, Payload::Sample}) {
        passes.nearest.payload = payload;
        variants.add(resolveKeysVariant(passes, keys64, normals));
    }
    passes.cell.emplace();
    variants.add(resolveKeysVariant(passes, keys64, normals));
    SplatPass pass;
    for (const SplatColoring coloring : colorings) {
        pass.coloring = coloring;
        for (const bool curved : {false, true}) {
            pass.curved = curved;
            variants.add(resolveSamplesVariant(pass, keys64, normals, false));
        }
        pass.curved = false;
        variants.add(resolveSamplesVariant(pass, keys64, normals, true));
    }
    pass.byIntensity = true;
    for (const bool owners : {false, true})
        variants.add(resolveSamplesVariant(pass, keys64, normals, owners));
    passes.sum.emplace().normals = normals;
    variants.add(resolveSumsVariant(passes, keys64, normals));
}

}  // namespace

std::vector<ShaderVariant> everySplatVariant() {
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
