#include "server/net/maps/map_request.hpp"

#include <algorithm>
#include <utility>

#include "protocol/problem.hpp"
#include "protocol/view/view_words.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/maps/map_words.hpp"

namespace scancast {
namespace {

constexpr std::uint32_t mostFeatures = 1'000'000;

/// A style is a colouring; the word `color` gives way to it.
Expected<void> applyStyle(const MapWords& words, std::string_view name, WordValues& view) {
    const std::string style = words.text(name);
    if (style.empty() || style == "default") return {};
    if (!checkWord("color", style))
        return wrongWord(
            name, "must be \"default\" or empty, or a colouring as the word color has them: elevation");
    std::erase_if(view, [](const auto& word) { return word.first == "color"; });
    view.emplace_back("color", style);
    return {};
}

Expected<void> checkLayer(const MapWords& words, std::string_view name, std::string_view layer) {
    const std::string* const asked = words.find(name);
    if (asked == nullptr || asked->empty() || *asked == layer) return {};
    return wrongWord(name, "must be \"" + std::string(layer) + "\": there is no other layer here");
}

Expected<void> checkService(const MapWords& words, std::string_view service) {
    const std::string asked = inCapitals(words.text("SERVICE"));
    if (asked.empty() || asked == service) return {};
    return wrongWord("SERVICE", "must be " + std::string(service) + " at this address");
}

/// What pictures have in common.
template <class Picture>
Expected<void> applyPicture(const MapWords& words, Picture& picture) {
    const auto format = mapFormatOf(words);
    if (!format) return passOn(format);
    picture.format = *format;
    const std::string transparent = inCapitals(words.text("TRANSPARENT"));
    if (!transparent.empty() && transparent != "TRUE" && transparent != "FALSE")
        return wrongWord("TRANSPARENT", "must be TRUE or FALSE");
    picture.transparent = transparent == "TRUE" && *format == PictureFormat::Png;
    const auto background = mapColorOf(words);
    if (!background) return passOn(background);
    picture.background = *background;
    return {};
}

/// What GetMap says, and GetFeatureInfo repeats.
Expected<MapRequest> mapOf(const MapWords& words, std::string_view layer, bool isOld) {
    MapRequest map;
    if (auto ok = checkLayer(words, "LAYERS", layer); !ok) return passOn(ok);
    const std::string_view crsName = isOld ? "SRS" : "CRS";
    const std::string* crs = words.find(crsName);
    if (crs == nullptr || crs->empty() || crs->size() > 64)
        return wrongWord(
            crsName,
            "must name a coordinate reference system: EPSG:3857, or file for the cloud's own coordinates");
    map.crs = lowerCase(*crs) == fileCrs ? std::string(fileCrs) : inCapitals(*crs);
    const auto box = mapBoxOf(words);
    if (!box) return passOn(box);
    map.box = *box;
    map.axesOfCrs = !isOld;
    const auto width = mapSideOf(words, "WIDTH");
    if (!width) return passOn(width);
    const auto height = mapSideOf(words, "HEIGHT");
    if (!height) return passOn(height);
    map.width = *width;
    map.height = *height;
    if (auto ok = applyPicture(words, map); !ok) return passOn(ok);
    map.words = words.view;
    if (auto ok = applyStyle(words, "STYLES", map.words); !ok) return passOn(ok);
    return map;
}

Expected<FeatureRequest> featureOf(const MapWords& words, std::string_view layer, bool isOld) {
    auto map = mapOf(words, layer, isOld);
    if (!map) return passOn(std::move(map));
    if (auto ok = checkLayer(words, "QUERY_LAYERS", layer); !ok) return passOn(ok);
    FeatureRequest request{std::move(*map)};
    const auto at = [&](std::string_view name, int side) -> Expected<int> {
        const auto pixel = mapWholeOf(words.text(name), std::uint32_t(side - 1));
        if (!pixel) return wrongWord(name, "must be a pixel of the map, counted from 0");
        return int(*pixel);
    };
    const auto i = at(isOld ? "X" : "I", request.map.width);
    if (!i) return passOn(i);
    const auto j = at(isOld ? "Y" : "J", request.map.height);
    if (!j) return passOn(j);
    request.i = *i;
    request.j = *j;
    // There is one point that is seen in a pixel, so one feature, however many somebody would take.
    const std::string* const count = words.find("FEATURE_COUNT");
    if (count != nullptr && !count->empty() && mapWholeOf(*count, mostFeatures).value_or(0) == 0)
        return wrongWord("FEATURE_COUNT", "must be a number of points, 1 or more: one is answered");
    const std::string format = lowerCase(words.text("INFO_FORMAT"));
    if (format.empty()) return request;
    const auto known = std::ranges::find(infoFormatNames, format);
    if (known == infoFormatNames.end())
        return wrongWord("INFO_FORMAT",
                         "must be application/json, application/geo+json, text/plain or text/html");
    request.format = InfoFormat(known - infoFormatNames.begin());
    return request;
}

Expected<LegendRequest> legendOf(const MapWords& words, std::string_view layer) {
    for (const char* name : {"LAYER", "LAYERS"})
        if (auto ok = checkLayer(words, name, layer); !ok) return passOn(ok);
    if (!words.text("RULE").empty())
        return wrongWord("RULE", "names no part of a legend here: ask for all of it");
    LegendRequest request;
    if (auto ok = applyPicture(words, request); !ok) return passOn(ok);
    request.words = words.view;
    // STYLE is the standard's; programs that repeat a map's words say STYLES.
    for (const char* name : {"STYLES", "STYLE"})
        if (auto ok = applyStyle(words, name, request.words); !ok) return passOn(ok);
    return request;
}

Expected<PictureFormat> formatOfName(std::string_view name) {
    if (name == "png") return PictureFormat::Png;
    if (name == "jpg" || name == "jpeg") return PictureFormat::Jpeg;
    return wrongWord("FORMAT", "must be png or jpg, as it ends the address");
}

Expected<TileRequest> tileOf(const MapWords& words, std::string_view set, std::string_view z,
                             std::string_view x, std::string_view y) {
    TileRequest tile;
    if (set != mercatorSet && set != fileCrs)
        return wrongWord("TILEMATRIXSET", "must be mercator, or file for the cloud's own coordinates");
    tile.set = std::string(set);
    const auto level = mapWholeOf(z, mostTileLevels - 1);
    if (!level) return wrongWord("TILEMATRIX", "must be a level, 0 to 24");
    tile.z = int(*level);
    const std::uint32_t last = (std::uint32_t(1) << *level) - 1;
    const auto column = mapWholeOf(x, last), row = mapWholeOf(y, last);
    if (!column) return wrongWord("TILECOL", "must be a column of that level, 0 to " + std::to_string(last));
    if (!row) return wrongWord("TILEROW", "must be a row of that level, 0 to " + std::to_string(last));
    tile.x = *column;
    tile.y = *row;
    tile.words = words.view;
    if (auto ok = applyStyle(words, "STYLE", tile.words); !ok) return passOn(ok);
    return tile;
}

}  // namespace

Expected<WmsRequest> parseWmsRequest(std::string_view query, std::string_view layer) {
    const auto words = mapWords(query);
    if (!words) return passOn(words);
    if (auto ok = checkService(*words, "WMS"); !ok) return passOn(ok);
    const std::string request = lowerCase(words->text("REQUEST"));
    std::string version = words->text("VERSION");
    // Versions are agreed on: who knows no more than 1.1 gets 1.1.1, everybody else 1.3.0.
    if (request.empty() || request == "getcapabilities" || request == "capabilities")
        return CapabilitiesRequest{words->view, version.starts_with("1.1.") || version.starts_with("1.0.")};
    if (request == "getlegendgraphic") {
        auto legend = legendOf(*words, layer);
        if (!legend) return passOn(std::move(legend));
        return std::move(*legend);
    }
    if (version.empty()) version = words->find("SRS") != nullptr ? "1.1.1" : "1.3.0";
    if (version != "1.3.0" && version != "1.1.1" && version != "1.1.0")
        return wrongWord("VERSION", "must be 1.3.0 or 1.1.1");
    const bool isOld = version != "1.3.0";
    if (request == "getmap" || request == "map") {
        auto map = mapOf(*words, layer, isOld);
        if (!map) return passOn(std::move(map));
        return std::move(*map);
    }
    if (request == "getfeatureinfo" || request == "feature_info") {
        auto feature = featureOf(*words, layer, isOld);
        if (!feature) return passOn(std::move(feature));
        return std::move(*feature);
    }
    return wrongWord("REQUEST", "must be GetCapabilities, GetMap, GetFeatureInfo or GetLegendGraphic");
}

Expected<WmtsRequest> parseWmtsRequest(std::string_view query, std::string_view layer) {
    const auto words = mapWords(query);
    if (!words) return passOn(words);
    if (auto ok = checkService(*words, "WMTS"); !ok) return passOn(ok);
    const std::string request = lowerCase(words->text("REQUEST"));
    if (request.empty() || request == "getcapabilities") return CapabilitiesRequest{words->view};
    if (request != "gettile") return wrongWord("REQUEST", "must be GetCapabilities or GetTile");
    if (auto ok = checkLayer(*words, "LAYER", layer); !ok) return passOn(ok);
    const auto format = mapFormatOf(*words);
    if (!format) return passOn(format);
    auto tile = tileOf(*words, words->text("TILEMATRIXSET"), words->text("TILEMATRIX"),
                       words->text("TILECOL"), words->text("TILEROW"));
    if (!tile) return passOn(std::move(tile));
    tile->format = *format;
    return std::move(*tile);
}

Expected<TileRequest> parseTileRequest(std::string_view set, std::string_view z, std::string_view x,
                                       std::string_view last, std::string_view query) {
    const auto words = mapWords(query);
    if (!words) return passOn(words);
    for (const auto& [name, value] : words->standard)
        if (name != "STYLE") return wrongWord(name, "has no part in the address of a tile");
    const auto dot = last.rfind('.');
    const auto format =
        formatOfName(dot == std::string_view::npos ? std::string_view() : last.substr(dot + 1));
    if (!format) return passOn(format);
    auto tile = tileOf(*words, set, z, x, last.substr(0, dot));
    if (!tile) return passOn(std::move(tile));
    tile->format = *format;
    return tile;
}

bool wantsProblems(std::string_view query) {
    const auto words = parseQuery(query);
    return words && std::ranges::any_of(*words, [](const auto& word) {
               return inCapitals(word.first) == "EXCEPTIONS" && word.second == problemMediaType;
           });
}

Expected<WordValues> parseMapWords(std::string_view query) {
    auto words = mapWords(query);
    if (!words) return passOn(std::move(words));
    return std::move(words->view);
}

}  // namespace scancast
