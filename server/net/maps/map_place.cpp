#include "server/net/maps/map_place.hpp"

#include <utility>

namespace scancast {
namespace {

bool isMercator(std::string_view crs) {
    return crs == "EPSG:3857" || crs == "EPSG:900913" || crs == "EPSG:3785";
}

bool isLonLat(std::string_view crs) {
    return crs == "EPSG:4326" || crs == "CRS:84" || crs == "OGC:CRS84" || crs == "OGC:84";
}

MapExtent extentOf(const MapRequest& map, bool yFirst) {
    const auto& box = map.box;
    MapExtent extent{{box[0], box[1]}, {box[2], box[3]}, map.width, map.height};
    if (yFirst) {
        std::swap(extent.low.x, extent.low.y);
        std::swap(extent.high.x, extent.high.y);
    }
    return extent;
}

}  // namespace

bool needsReference(const MapRequest& map) {
    return map.crs != fileCrs;
}

Expected<MapPlacement> placementOf(const MapRequest& map, const Expected<GeoReference>& geo) {
    if (map.crs == fileCrs) return MapPlacement{extentOf(map, false), {}};
    if (!geo) {
        Error error = geo.error();
        error.message += " Ask for it in the cloud's own coordinates: file.";
        return tl::unexpected(std::move(error));
    }
    const FileCrs& file = geo->file();
    const std::string own = file.epsg ? "EPSG:" + std::to_string(*file.epsg) : std::string();
    if (map.crs == own) return MapPlacement{extentOf(map, map.axesOfCrs && file.northFirst), {}};
    if (!isMercator(map.crs) && !isLonLat(map.crs)) {
        std::string message = map.crs;
        message.append(" is no coordinate reference system of this map; it has ");
        if (!own.empty()) message.append(own).append(", ");
        message.append("EPSG:3857, EPSG:4326, CRS:84, and file, the cloud's own coordinates.");
        return fail(ErrorCode::InvalidArgument, std::move(message), map.axesOfCrs ? "CRS" : "SRS");
    }
    const WorldCrs world = isMercator(map.crs) ? WorldCrs::WebMercator : WorldCrs::LonLat;
    MapPlacement placement{extentOf(map, map.axesOfCrs && map.crs == "EPSG:4326"), {}};
    placement.projection.toCloud = [&reference = *geo, world](std::span<glm::dvec2> places) {
        reference.toFile(world, places);
    };
    placement.projection.fromCloud = [&reference = *geo, world](std::span<glm::dvec2> places) {
        reference.fromFile(world, places);
    };
    return placement;
}

}  // namespace scancast
