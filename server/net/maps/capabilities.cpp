#include "server/net/maps/capabilities.hpp"

#include <cmath>
#include <limits>

#include "protocol/view/view_words.hpp"
#include "renderer/plan.hpp"

namespace scancast {
namespace {

constexpr int placesOfEdge = 21;

/// Of a raster of places within the bounds; nullopt where one of them has no place there.
std::optional<MapBounds> boundsIn(WorldCrs world, const MapBounds& bounds, const GeoReference& geo) {
    std::vector<glm::dvec2> places;
    for (int row = 0; row < placesOfEdge; ++row)
        for (int column = 0; column < placesOfEdge; ++column)
            places.push_back(bounds[0] +
                             (bounds[1] - bounds[0]) * (glm::dvec2(column, row) / double(placesOfEdge - 1)));
    geo.fromFile(world, places);
    constexpr double everything = std::numeric_limits<double>::infinity();
    MapBounds found{glm::dvec2(everything), glm::dvec2(-everything)};
    for (const glm::dvec2& place : places) {
        if (!std::isfinite(place.x)) return std::nullopt;
        for (int a = 0; a < 2; ++a) {
            found[0][a] = std::min(found[0][a], place[a]);
            found[1][a] = std::max(found[1][a], place[a]);
        }
    }
    return found;
}

/// Colourings that this cloud has.
std::vector<std::string> stylesOf(const Cloud& cloud) {
    std::vector<std::string> styles;
    for (const std::string_view name : colorSourceNames) {
        if (name == colorSourceNames.front()) continue;
        View view = defaultView(cloud, tileSide, tileSide);
        if (applyWord(view, "color", name) && checkView(cloud, view)) styles.emplace_back(name);
    }
    return styles;
}

}  // namespace

MapFacts mapFacts(const Cloud& cloud, const GeoReference* geo) {
    MapFacts facts;
    facts.title = cloud.title;
    facts.attribution = cloud.attribution;
    facts.styles = stylesOf(cloud);
    facts.bounds = {glm::dvec2(cloud.bounds[0]), glm::dvec2(cloud.bounds[1])};
    if (geo == nullptr) return facts;
    facts.crs = geo->file();
    facts.lonLat = boundsIn(WorldCrs::LonLat, facts.bounds, *geo);
    facts.mercator = boundsIn(WorldCrs::WebMercator, facts.bounds, *geo);
    return facts;
}

}  // namespace scancast
