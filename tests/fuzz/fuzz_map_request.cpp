// Requests for maps, and for places as longitudes and latitudes with their answers: the first byte says which. Whatever is accepted must be within its bounds, and tiles within their level.
#include <cstdlib>
#include <string>

#include "protocol/json_text.hpp"
#include "protocol/points/lonlat_request.hpp"
#include "server/net/maps/map_request.hpp"
#include "server/net/maps/service_exception.hpp"
#include "server/net/maps/tile_sets.hpp"
#include "tests/fuzz/require.hpp"

namespace scancast {
namespace {

void check(const MapRequest& map) {
    require(map.width >= 1 && map.width <= maxPictureSide && map.height >= 1 && map.height <= maxPictureSide);
    require(map.box[0] < map.box[2] && map.box[1] < map.box[3]);
    require(!(map.transparent && map.format == PictureFormat::Jpeg));
}

void check(const TileRequest& tile) {
    require(tile.z < mostTileLevels && tile.x >> tile.z == 0 && tile.y >> tile.z == 0);
    const MapExtent extent = mercatorTiles().extentOf(tile.z, tile.x, tile.y);
    require(extent.low.x < extent.high.x && extent.low.y < extent.high.y);
}

template <class Parsed>
void checkRefusal(const Parsed& parsed, MapService service) {
    if (parsed) return;
    const std::string text = exceptionResponse(service, problemOf(parsed.error()), parsed.error().field).text;
    require(text.find('\0') == std::string::npos && !text.empty());
}

}  // namespace
}  // namespace scancast

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    if (data[0] == 's') {
        const auto wms = parseWmsRequest(text, "town");
        checkRefusal(wms, MapService::Wms);
        if (!wms) return 0;
        if (const auto* map = std::get_if<MapRequest>(&*wms)) check(*map);
        if (const auto* legend = std::get_if<LegendRequest>(&*wms))
            require(!(legend->transparent && legend->format == PictureFormat::Jpeg));
        if (const auto* feature = std::get_if<FeatureRequest>(&*wms)) {
            check(feature->map);
            require(feature->i < feature->map.width && feature->j < feature->map.height && feature->i >= 0 &&
                    feature->j >= 0);
        }
        return 0;
    }
    if (data[0] == 't') {
        const auto wmts = parseWmtsRequest(text, "town");
        checkRefusal(wmts, MapService::Wmts);
        if (wmts && std::holds_alternative<TileRequest>(*wmts)) check(std::get<TileRequest>(*wmts));
        return 0;
    }
    if (data[0] == 'l') {
        const auto request = parseLonLatRequest(text);
        if (request) {
            require(!request->points.empty() && request->points.size() <= mostLonLatPoints);
            require(parseLonLatRequest(printJson(toJson(*request))).value() == *request);
        }
        const auto answer = parseJson(text);
        const auto points = answer ? parseLonLatAnswer(*answer) : LonLatPoints{};
        if (points) require(printJson(toJson(*points)).front() == '[');
        return 0;
    }
    // set/z/x/y?query
    std::string_view parts[4], rest = text.substr(0, text.find('?'));
    const std::string_view query =
        rest.size() < text.size() ? text.substr(rest.size() + 1) : std::string_view();
    for (std::string_view& part : parts) {
        part = rest.substr(0, rest.find('/'));
        rest = part.size() < rest.size() ? rest.substr(part.size() + 1) : std::string_view();
    }
    const auto tile = parseTileRequest(parts[0], parts[1], parts[2], parts[3], query);
    checkRefusal(tile, MapService::Plain);
    if (tile) check(*tile);
    return 0;
}
