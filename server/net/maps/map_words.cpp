#include "server/net/maps/map_words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

#include "protocol/view/view_words.hpp"
#include "server/net/api/http_message.hpp"

namespace scancast {
namespace {

/// Of the standards, in capitals; what several versions or programs say and nothing follows from is among them.
constexpr std::string_view standardNames[] = {"SERVICE",
                                              "VERSION",
                                              "REQUEST",
                                              "LAYERS",
                                              "LAYER",
                                              "STYLES",
                                              "STYLE",
                                              "CRS",
                                              "SRS",
                                              "BBOX",
                                              "WIDTH",
                                              "HEIGHT",
                                              "FORMAT",
                                              "TRANSPARENT",
                                              "BGCOLOR",
                                              "EXCEPTIONS",
                                              "QUERY_LAYERS",
                                              "INFO_FORMAT",
                                              "FEATURE_COUNT",
                                              "I",
                                              "J",
                                              "X",
                                              "Y",
                                              "TILEMATRIXSET",
                                              "TILEMATRIX",
                                              "TILEROW",
                                              "TILECOL",
                                              "UPDATESEQUENCE",
                                              "ACCEPTVERSIONS",
                                              "SECTIONS",
                                              "ACCEPTFORMATS",
                                              "DPI",
                                              "MAP_RESOLUTION",
                                              "FORMAT_OPTIONS",
                                              "TILED",
                                              "WMTVER",
                                              "SLD_VERSION",
                                              "SERVICE_VERSION",
                                              "FEATURETYPE",
                                              "RULE",
                                              "SCALE",
                                              "TIME",
                                              "ELEVATION",
                                              "SLD",
                                              "SLD_BODY"};

constexpr double farthest = 1e15;

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

std::optional<double> mapNumberOf(std::string_view text) {
    double value = 0;
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size() || !(std::abs(value) <= farthest))
        return std::nullopt;
    return value;
}

}  // namespace

const std::string* MapWords::find(std::string_view name) const {
    for (const auto& [key, value] : standard)
        if (key == name) return &value;
    return nullptr;
}

std::string MapWords::text(std::string_view name) const {
    const std::string* const value = find(name);
    return value == nullptr ? std::string() : *value;
}

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

Expected<MapWords> mapWords(std::string_view query) {
    auto all = parseQuery(query);
    if (!all) return passOn(all);
    MapWords words;
    for (auto& [name, value] : *all) {
        std::string upper = inCapitals(name);
        if (name.empty() && value.empty()) continue;  // "?&SERVICE=…", as programs put it together
        if (std::ranges::find(standardNames, upper) == std::end(standardNames)) {
            words.view.emplace_back(std::move(name), std::move(value));
            continue;
        }
        if (words.find(upper) != nullptr) return wrongWord(upper, "is given twice");
        words.standard.emplace_back(std::move(upper), std::move(value));
    }
    if (auto ok = checkViewWords(words.view); !ok) return passOn(ok);
    // What would be another map than the one that is meant is not passed over.
    for (const char* name : {"SLD", "SLD_BODY", "TIME", "ELEVATION"}) {
        const std::string value = words.text(name);
        if (!value.empty() && value != "default")
            return wrongWord(name, "is not supported by this server; styles are the words of a view");
    }
    return words;
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

Expected<int> mapSideOf(const MapWords& words, std::string_view name) {
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

Expected<Rgb8> mapColorOf(const MapWords& words) {
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

}  // namespace scancast
