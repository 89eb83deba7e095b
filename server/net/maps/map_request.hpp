// What is asked of a cloud's maps: WMS 1.3.0 and 1.1.1, WMTS 1.0.0 and tiles, in the words of their standards - whose names are written in
// any case - and in words of a view, which everything else must be. Outside bytes; pure functions; any thread.
// Pipeline: router → **map request** → map answers.
//
// Errors are InvalidArgument; their field is the standard's name in capitals ("CRS", "BBOX", "TILEROW"), by which a service says what is wrong
// (service_exception.hpp), or a word of a view.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "protocol/view/query.hpp"
#include "protocol/view/view.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {

/// The cloud's own coordinates, whatever they are; also the tile set in them.
inline constexpr std::string_view fileCrs = "file";
inline constexpr std::string_view mercatorSet = "mercator";

struct MapRequest {
    std::string crs;              ///< "EPSG:25833", in capitals, or fileCrs
    std::array<double, 4> box{};  ///< as given: two lower and two upper bounds
    bool axesOfCrs = false;       ///< they are in the order of the system's axes, which may be y, x
    int width = 0, height = 0;    ///< px
    PictureFormat format = PictureFormat::Png;
    bool transparent = false;        ///< of PNG
    Rgb8 background{255, 255, 255};  ///< where it is not
    WordValues words{};              ///< of a view
};

enum class InfoFormat : std::uint8_t { Json, GeoJson, Text, Html };
inline constexpr std::array<std::string_view, 4> infoFormatNames{"application/json", "application/geo+json",
                                                                 "text/plain", "text/html"};

struct FeatureRequest {
    MapRequest map;
    int i = 0, j = 0;  ///< px from the map's upper left one
    InfoFormat format = InfoFormat::Json;
};

struct CapabilitiesRequest {
    WordValues words{};  ///< that addresses in it have, too
    bool isOld = false;  ///< of WMS: 1.1.1
};

/// What colours mean, as a picture: GetLegendGraphic (OGC 05-078r4).
struct LegendRequest {
    PictureFormat format = PictureFormat::Png;
    bool transparent = false;        ///< of PNG
    Rgb8 background{255, 255, 255};  ///< where it is not
    WordValues words{};              ///< of a view
};

/// Pixels of tiles, each side.
inline constexpr int tileSide = 256;
/// Levels of a set at most, and so digits of a tile's numbers.
inline constexpr int mostTileLevels = 25;

struct TileRequest {
    std::string set;
    int z = 0;
    std::uint32_t x = 0, y = 0;  ///< from the upper left, within 2^z
    PictureFormat format = PictureFormat::Png;
    WordValues words{};
};

using WmsRequest = std::variant<CapabilitiesRequest, MapRequest, FeatureRequest, LegendRequest>;
/// `layer`: the only one that there is.
Expected<WmsRequest> parseWmsRequest(std::string_view query, std::string_view layer);

using WmtsRequest = std::variant<CapabilitiesRequest, TileRequest>;
Expected<WmtsRequest> parseWmtsRequest(std::string_view query, std::string_view layer);

/// Of a path: `last` is the row with .png or .jpg. `style` may stand in the query, as in WMTS's.
Expected<TileRequest> parseTileRequest(std::string_view set, std::string_view z, std::string_view x,
                                       std::string_view last, std::string_view query);

/// Whether what is wrong shall be said as everywhere else (RFC 9457), not in the service's words: EXCEPTIONS=application/problem+json.
bool wantsProblems(std::string_view query);

/// The words of a view in a query of nothing else; `style` is what a service's style is.
Expected<WordValues> parseMapWords(std::string_view query);

}  // namespace scancast
