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

/// Colourings that this cloud has; those that this view has no part in are left out.
std::vector<MapStyle> stylesOf(const Cloud& cloud, const View& asked) {
    std::vector<MapStyle> styles;
    for (const std::string_view name : colorSourceNames) {
        const bool isDefault = name == colorSourceNames.front();
        View view = asked;
        if (!isDefault && !applyWord(view, "color", name)) continue;
        const auto planned = plan(cloud, view);
        if (!planned) continue;
        const MapLegend legend = mapLegend(cloud, **planned);
        styles.push_back({isDefault ? "default" : std::string(name),
                          isDefault ? "as the cloud is best seen: " + (*planned)->colorName : legend.title,
                          legendSize(legend)});
    }
    return styles;
}

}  // namespace

std::string legendAddress(const MapFacts& facts, const MapStyle& style) {
    const std::string words = printQuery(facts.words);
    std::string address = facts.address + "/wms?";
    if (!words.empty()) address += words + "&";
    return address +
           "SERVICE=WMS&VERSION=1.3.0&REQUEST=GetLegendGraphic&SLD_VERSION=1.1.0&FORMAT=image/png&LAYER=" +
           facts.layer + "&STYLE=" + style.name;
}

MapFacts mapFacts(const Cloud& cloud, const View& view, const GeoReference* geo) {
    MapFacts facts;
    facts.title = cloud.title;
    facts.attribution = cloud.attribution;
    facts.styles = stylesOf(cloud, view);
    facts.bounds = {glm::dvec2(cloud.bounds[0]), glm::dvec2(cloud.bounds[1])};
    if (geo == nullptr) return facts;
    facts.crs = geo->file();
    if (!facts.crs->epsg) facts.wkt = cloud.crsWkt;
    facts.lonLat = boundsIn(WorldCrs::LonLat, facts.bounds, *geo);
    facts.mercator = boundsIn(WorldCrs::WebMercator, facts.bounds, *geo);
    return facts;
}

}  // namespace scancast
