// Which part of the world a tile shows. Two sets, of tiles of 256 x 256 pixels, 2^z of them on each side of level z, counted from the upper
// left: `mercator`, what maps of the web have (GoogleMapsCompatible), and `file`, in the cloud's own coordinates:
//
//  - a pixel of level 0 is the smallest power of two, in the cloud's unit, of which one tile covers the cloud's bounds, wherever between
//    multiples of a pixel they lie; each level halves it;
//  - the upper left corner of all levels is the largest multiple of that pixel that is no larger than the bounds' least x, and the
//    smallest that is no smaller than their greatest y;
//  - levels go on until a pixel is an eighth of the scan's spacing.
//
// Pure functions; any thread. Pipeline: tile request → **tile sets** → map picture.
#pragma once

#include <glm/vec2.hpp>

#include "renderer/map/map_picture.hpp"
#include "server/net/maps/map_request.hpp"

namespace scancast {

struct TileSet {
    glm::dvec2 corner{0};  ///< upper left of all tiles
    double pixel = 1;      ///< of level 0, units
    int levels = 1;
    double side(int z) const;  ///< of a tile of that level, units
    MapExtent extentOf(int z, std::uint32_t x, std::uint32_t y) const;
};

TileSet mercatorTiles();
TileSet fileTiles(const CloudFacts& cloud);

/// Columns and rows of a level that have something in these bounds, both ends included.
struct TileRange {
    std::uint32_t left = 0, right = 0, top = 0, bottom = 0;
};
TileRange tilesIn(const TileSet& set, int z, const glm::dvec2& low, const glm::dvec2& high);

}  // namespace scancast
