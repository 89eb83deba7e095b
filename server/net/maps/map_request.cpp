#include "server/net/maps/map_request.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "protocol/view/view_words.hpp"
#include "server/net/api/http_message.hpp"

namespace scancast {
namespace {

/// Of the standards, in capitals; what several versions or programs say and nothing follows from is among them.
constexpr std::array standardNames{std::string_view("SERVICE"),
                                   std::string_view("VERSION"),
                                   std::string_view("REQUEST"),
                                   std::string_view("LAYERS"),
                                   std::string_view("LAYER"),
                                   std::string_view("STYLES"),
                                   std::string_view("STYLE"),
                                   std::string_view("CRS"),
                                   std::string_view("SRS"),
                                   std::string_view("BBOX"),
                                   std::string_view("WIDTH"),
                                   std::string_view("HEIGHT"),
                                   std::string_view("FORMAT"),
                                   std::string_view("TRANSPARENT"),
                                   std::string_view("BGCOLOR"),
                                   std::string_view("EXCEPTIONS"),
                                   std::string_view("QUERY_LAYERS"),
                                   std::string_view("INFO_FORMAT"),
                                   std::string_view("FEATURE_COUNT"),
                                   std::string_view("I"),
                                   std::string_view("J"),
                                   std::string_view("X"),
                                   std::string_view("Y"),
                                   std::string_view("TILEMATRIXSET"),
                                   std::string_view("TILEMATRIX"),
                                   std::string_view("TILEROW"),
                                   std::string_view("TILECOL"),
                                   std::string_view("UPDATESEQUENCE"),
                                   std::string_view("ACCEPTVERSIONS"),
                                   std::string_view("SECTIONS"),
                                   std::string_view("ACCEPTFORMATS"),
                                   std::string_view("DPI"),
                                   std::string_view("MAP_RESOLUTION"),
                                   std::string_view("FORMAT_OPTIONS"),
                                   std::string_view("TILED"),
                                   std::string_view("WMTVER"),
                                   std::string_view("TIME"),
                                   std::string_view("ELEVATION"),
                                   std::string_view("SLD"),
                                   std::string_view("SLD_BODY")};

constexpr double farthest = 1e15;

std::string inCapitals(std::string_view text) {
    std::string upper(text);
    for (char& c : upper)
        if (c >= 'a' && c <= 'z') c = char(c - 'a' + 'A');
    return upper;
}

tl::unexpected<Error> wrongWord(std::string_view name, std::string_view must) {
    std::string message(name);
    message.append(" ").append(must);
    return fail(ErrorCode::InvalidArgument, std::move(message), std::string(name));
}

/// A query, as its standard's words and the view's.
struct MapWords {
    std::vector<std::pair<std::string, std::string>> standard;
    WordValues view;

    const std::string* find(std::string_view name) const {
        for (const auto& [key, value] : standard)
            if (key == name) return &value;
        return nullptr;
    }
    std::string text(std::string_view name) const {
        const std::string* const value = find(name);
        return value == nullptr ? std::string() : *value;
    }
};

bool isOfCamera(std::string_view word) {
    for (const ViewWord& known : viewWords())
        if (known.word == word)
            return known.path.starts_with("camera.") || word == "width" || word == "height";
    return false;
}

Expected<void> checkViewWords(const WordValues& words) {
    for (const auto& [word, value] : words) {
        if (isOfCamera(word))
            return fail(
                ErrorCode::InvalidArgument,
                word + ": a map looks straight down on what its bounds or its tile say, and has no camera",
                word);
        if (auto ok = checkWord(word, value); !ok) return ok;
    }
    return {};
}

Expected<MapWords> mapWordsOf(std::string_view query) {
    auto all = parseQuery(query);
    if (!all) return passOn(all);
    MapWords words;
    for (auto& [name, value] : *all) {
        std::string upper = inCapitals(name);
        if (name.empty() && value.empty()) continue;  // "?&SERVICE=…", as programs put it together
        if (std::ranges::find(standardNames, upper) == standardNames.end()) {
            words.view.emplace_back(std::move(name), std::move(value));
            continue;
        }
        if (words.find(upper) != nullptr) return wrongWord(upper, "is given twice");
        words.standard.emplace_back(std::move(upper), std::move(value));
    }
    if (auto ok = checkViewWords(words.view); !ok) return passOn(ok);
    return words;
}

std::optional<double> mapNumberOf(std::string_view text) {
    double value = 0;
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size() || !(std::abs(value) <= farthest))
        return std::nullopt;
    return value;
}

std::optional<std::uint32_t> mapWholeOf(std::string_view text, std::uint32_t most) {
    std::uint32_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size() || value > most) return std::nullopt;
    return value;
}

Expected<std::array<double, 4>> mapBoxOf(const MapWords& words) {
    const std::string* const text = words.find("BBOX");
    constexpr std::string_view must =
        "must be four numbers, two lower bounds and two upper ones that are larger: "
        "389400,5819700,389600,5819900";
    if (text == nullptr) return wrongWord("BBOX", must);
    std::array<double, 4> box{};
    std::string_view rest = *text;
    for (std::size_t i = 0; i < box.size(); ++i) {
        const auto comma = rest.find(',');
        if ((comma == std::string_view::npos) != (i == 3)) return wrongWord("BBOX", must);
        const auto number = mapNumberOf(rest.substr(0, comma));
        if (!number) return wrongWord("BBOX", must);
        box[i] = *number;
        rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
    }
    if (!(box[0] < box[2] && box[1] < box[3])) return wrongWord("BBOX", must);
    return box;
}

Expected<int> sideOf(const MapWords& words, std::string_view name) {
    const auto side = mapWholeOf(words.text(name), std::uint32_t(maxPictureSide));
    if (!side || *side == 0) return wrongWord(name, "must be a number of pixels, 1 to 16384");
    return int(*side);
}

Expected<PictureFormat> mapFormatOf(const MapWords& words) {
    std::string format = lowerCase(words.text("FORMAT"));
    format = format.substr(0, format.find(';'));
    if (format.empty() || format == "image/png" || format == "image/png8") return PictureFormat::Png;
    if (format == "image/jpeg" || format == "image/jpg") return PictureFormat::Jpeg;
    return wrongWord("FORMAT", "must be image/png or image/jpeg");
}

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

Expected<Rgb8> colorOf(const MapWords& words) {
    std::string_view text;
    const std::string* const given = words.find("BGCOLOR");
    if (given == nullptr || given->empty()) return Rgb8{255, 255, 255};
    text = *given;
    if (text.starts_with("0x") || text.starts_with("0X")) text.remove_prefix(2);
    if (text.starts_with('#')) text.remove_prefix(1);
    std::uint32_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (text.size() != 6 || problem != std::errc() || end != text.data() + text.size())
        return wrongWord("BGCOLOR", "must be a colour: 0xFFFFFF");
    return Rgb8{std::uint8_t(value >> 16), std::uint8_t(value >> 8 & 255), std::uint8_t(value & 255)};
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
    const auto width = sideOf(words, "WIDTH");
    if (!width) return passOn(width);
    const auto height = sideOf(words, "HEIGHT");
    if (!height) return passOn(height);
    map.width = *width;
    map.height = *height;
    const auto format = mapFormatOf(words);
    if (!format) return passOn(format);
    map.format = *format;
    const std::string transparent = inCapitals(words.text("TRANSPARENT"));
    if (!transparent.empty() && transparent != "TRUE" && transparent != "FALSE")
        return wrongWord("TRANSPARENT", "must be TRUE or FALSE");
    map.transparent = transparent == "TRUE" && *format == PictureFormat::Png;
    const auto background = colorOf(words);
    if (!background) return passOn(background);
    map.background = *background;
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
    const std::string format = lowerCase(words.text("INFO_FORMAT"));
    if (format.empty()) return request;
    const auto known = std::ranges::find(infoFormatNames, format);
    if (known == infoFormatNames.end())
        return wrongWord("INFO_FORMAT",
                         "must be application/json, application/geo+json, text/plain or text/html");
    request.format = InfoFormat(known - infoFormatNames.begin());
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
    const auto words = mapWordsOf(query);
    if (!words) return passOn(words);
    if (auto ok = checkService(*words, "WMS"); !ok) return passOn(ok);
    const std::string request = lowerCase(words->text("REQUEST"));
    if (request.empty() || request == "getcapabilities" || request == "capabilities")
        return CapabilitiesRequest{words->view};
    std::string version = words->text("VERSION");
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
    return wrongWord("REQUEST", "must be GetCapabilities, GetMap or GetFeatureInfo");
}

Expected<WmtsRequest> parseWmtsRequest(std::string_view query, std::string_view layer) {
    const auto words = mapWordsOf(query);
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
    const auto words = mapWordsOf(query);
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
    auto words = mapWordsOf(query);
    if (!words) return passOn(std::move(words));
    return std::move(words->view);
}

}  // namespace scancast
