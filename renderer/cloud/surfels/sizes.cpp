#include "renderer/cloud/surfels/sizes.hpp"

#include <algorithm>

namespace scancast {

namespace {

/// Beside what is much denser - where two scans overlap - a surface's own distances close it; farther than this
/// nothing on one surface is.
constexpr float surfaceFactor = 4;
constexpr float edgeFactor = 1.25f;
constexpr float edgeSpacings = 1.5f;
/// Of s between the points of a wire the eight nearest are 2.5 s away on average: it stays closed.
constexpr float wireShare = 0.25f;
/// Discs of leaves hardly overlap, and five layers of them hide most of what is behind.
constexpr float foliageShare = 0.4f;
/// A rough surface has one layer only, which has to close.
constexpr float roughShare = 1;

}  // namespace

float largestRadius(const Surfel& surfel, Density density, double levelSpacing) {
    const float usual = surfel.usual > 0 ? surfel.usual : surfel.radius;
    const auto level = float(levelSpacing);
    switch (density) {
        case Density::Surface:
            return surfaceFactor * usual;
        case Density::Edge:
            return std::min(edgeFactor * usual, edgeSpacings * level);
        case Density::Wire:
            return std::min(wireShare * surfel.nearby, level);
        case Density::Foliage:
        case Density::Stray:
            return std::min({(foliageShare + (roughShare - foliageShare) * surfel.rough) * surfel.nearby,
                             edgeFactor * usual, level});
    }
    return surfel.radius;
}

void shrink(Surfel& surfel, float largest) {
    if (!(surfel.radius > largest)) return;
    const float share = largest / surfel.radius;
    surfel.radius = largest;
    surfel.major *= share;
    surfel.minor *= share;
}

}  // namespace scancast
