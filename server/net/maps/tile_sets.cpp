#include "server/net/maps/tile_sets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scancast {
namespace {

/// Pixels of the finest level in the distance of neighbouring points.
constexpr double finest = 8;

}  // namespace

double TileSet::side(int z) const {
    return std::ldexp(pixel * tileSide, -z);
}

MapExtent TileSet::extentOf(int z, std::uint32_t x, std::uint32_t y) const {
    const double tile = side(z);
    const glm::dvec2 left(corner.x + tile * x, corner.y - tile * (double(y) + 1));
    return {left, {corner.x + tile * (double(x) + 1), corner.y - tile * y}, tileSide, tileSide};
}

TileSet mercatorTiles() {
    constexpr double half = std::numbers::pi * 6378137;
    return {{-half, half}, 2 * half / tileSide, mostTileLevels};
}

TileSet fileTiles(const CloudFacts& cloud) {
    const glm::dvec3 size = cloud.bounds[1] - cloud.bounds[0];
    const double span = std::max({size.x, size.y, cloud.spacing, 1e-3});
    TileSet set;
    for (int power = std::ilogb(span / tileSide);; ++power) {
        set.pixel = std::ldexp(1.0, power);
        set.corner = {std::floor(cloud.bounds[0].x / set.pixel) * set.pixel,
                      std::ceil(cloud.bounds[1].y / set.pixel) * set.pixel};
        const double right = set.corner.x + set.side(0), bottom = set.corner.y - set.side(0);
        if (right >= cloud.bounds[1].x && bottom <= cloud.bounds[0].y) break;
    }
    const double spacing = cloud.spacing > 0 ? cloud.spacing : span / 1000;
    set.levels = std::clamp(int(std::ceil(std::log2(set.pixel * finest / spacing))) + 1, 1, mostTileLevels);
    return set;
}

TileRange tilesIn(const TileSet& set, int z, const glm::dvec2& low, const glm::dvec2& high) {
    const double tile = set.side(z), last = std::ldexp(1.0, z) - 1;
    const auto number = [&](double distance) {
        return std::uint32_t(std::clamp(std::floor(distance / tile), 0.0, last));
    };
    return {number(low.x - set.corner.x), number(high.x - set.corner.x), number(set.corner.y - high.y),
            number(set.corner.y - low.y)};
}

}  // namespace scancast
