// A map of a cloud, seen from straight above with north up: which picture is drawn for it, and how that becomes the map.
//
// Where the map is in the cloud's coordinates and its pixels are square, the picture is the map, with a margin around it that screen
// passes look at, so that neighbouring tiles fit. Else the picture covers the map's part of the cloud in the cloud's own coordinates,
// at least as finely as the map, and the map is made of it pixel by pixel: places between the nodes of a net, where the projection is
// asked, are interpolated, to within a quarter of a pixel (docs/decisions/034-maps.md).
//
// Pure functions; any thread, or the one whose the projection is. Pipeline: extent → **map picture** → plan → … → frame → **warp** → encode.
#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/image/frame.hpp"

namespace scancast {

/// What a map shows: from edge to edge of its outermost pixels, in its own coordinates, x to the right and y up.
struct MapExtent {
    glm::dvec2 low{0}, high{1};
    int width = 0, height = 0;  ///< px
    /// Of a place in the picture, px from its upper left corner: centres of pixels are at +0.5.
    glm::dvec2 placeAt(const glm::dvec2& pixel) const;
    bool operator==(const MapExtent&) const = default;
};

/// In place; what has no place there becomes infinite. Both empty: the map is in the cloud's coordinates.
struct MapProjection {
    std::function<void(std::span<glm::dvec2>)> toCloud, fromCloud;
};

/// How a picture becomes a map. Immutable.
struct MapWarp {
    int width = 0, height = 0;  ///< of the map
    glm::ivec2 first{0},
        size{0};                ///< its pixels that have something of the picture: the others are background
    int step = 0;               ///< px between nodes of the net; 0: a pixel is the picture's at `offset`
    glm::ivec2 offset{0};       ///< of step 0
    int columns = 0, rows = 0;  ///< nodes
    std::vector<glm::dvec2> nodes{};  ///< places in the picture, px, of the corners of cells
    double error = 0;       ///< px of the picture that interpolation was off by, where it was looked at
    Rgb8 outside{0, 0, 0};  ///< of an opaque map
    bool opaque = false;

    /// Bilinear, with colours weighted by alpha. Cancelled.
    Expected<Frame> apply(const Frame& picture, const std::stop_token& stop = {}) const;
};

struct MapPicture {
    Camera camera;
    int width = 0, height = 0;                 ///< of the picture that is drawn, px
    std::shared_ptr<const MapWarp> warp = {};  ///< nullptr: it is the map
};

struct MapLimits {
    int margin = 0;                ///< px that screen passes look at around what they draw
    std::uint64_t mostPixels = 0;  ///< of the picture
    double mostError = 0.25;       ///< px
};

/// The camera of every map: orthographic, straight down on that middle.
Camera cameraAbove(const CloudFacts& cloud, const glm::dvec2& middle, double viewHeight);

/// nullopt: nothing of the cloud lies in it. ResourceLimit where the picture would be too large, or the projection bends too much for
/// that accuracy. `background`: nullopt = transparent.
Expected<std::optional<MapPicture>> mapPicture(const CloudFacts& cloud, const MapExtent& extent,
                                               const MapProjection& projection,
                                               const std::optional<Rgb8>& background,
                                               const MapLimits& limits);

/// A map without anything in it.
Frame emptyMap(int width, int height, const std::optional<Rgb8>& background);

/// Cloud units that a pixel is at that place of a map, both axes: the square root of its area. nullopt: it has no place there.
struct MapPlace {
    glm::dvec2 place{0};
    double unitsPerPixel = 0;
};
std::optional<MapPlace> placeUnder(const MapExtent& extent, const MapProjection& projection,
                                   const glm::dvec2& pixel);

}  // namespace scancast
