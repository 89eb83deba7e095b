// What a cloud's maps are, as services tell it: WMS 1.3.0 and WMTS 1.0.0 capabilities. Pure functions; any thread.
// Pipeline: map answers → **capabilities** → client.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/geo/geo_reference.hpp"
#include "renderer/map/map_legend.hpp"
#include "server/net/maps/map_request.hpp"

namespace scancast {

using MapBounds = std::array<glm::dvec2, 2>;  ///< low, high

struct MapStyle {
    std::string name, title;
    LegendSize legend;
};

/// All that is told.
struct MapFacts {
    std::string layer, title, attribution;
    std::string address;           ///< of the cloud: "https://scans.example.org/api/v1/clouds/town"
    WordValues words;              ///< of a view, that addresses shall have
    std::vector<MapStyle> styles;  ///< the default first
    std::optional<FileCrs> crs;    ///< empty: not known
    std::string wkt;               ///< of that, where it has no number
    MapBounds bounds{};            ///< in the cloud's coordinates
    std::optional<MapBounds> lonLat, mercator;  ///< empty: not known
    int widest = 0;                             ///< px, of a map's side
};

/// Bounds, in the world's systems where it is known; `geo` may be nullptr. `view`: a map's (asMap()), which says what the default
/// style is.
MapFacts mapFacts(const Cloud& cloud, const View& view, const GeoReference* geo);

/// Where the legend of a style is.
std::string legendAddress(const MapFacts& facts, const MapStyle& style);

/// `isOld`: as WMS 1.1.1 has it.
std::string wmsCapabilities(const MapFacts& facts, bool isOld);
/// `cloud`, that of the address, says what the tiles of its own coordinates are.
std::string wmtsCapabilities(const MapFacts& facts, const CloudFacts& cloud);

}  // namespace scancast
