#include "protocol/view/view_values.hpp"

#include <algorithm>
#include <charconv>

#include "protocol/nearest_name.hpp"
#include "protocol/view/hex_digit.hpp"

namespace scancast::values {
namespace {

using nlohmann::json;
using Names = std::span<const std::string_view>;

/// Which of the names the text is.
Parsed<std::size_t> choose(std::string_view text, Names names, std::string_view others = {}) {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found != names.end()) return std::size_t(found - names.begin());
    std::string message = quoteText(text) + " is none of ";
    for (std::size_t i = 0; i < names.size(); ++i) message += (i > 0 ? ", " : "") + std::string(names[i]);
    message += others;
    if (const auto nearest = nearestName(text, names); !nearest.empty())
        message += "; did you mean " + std::string(nearest) + "?";
    return tl::unexpected(message);
}

template <class Enum>
Parsed<Enum> chooseEnum(std::string_view text, Names names, std::string_view others = {}) {
    return choose(text, names, others).map([](std::size_t i) { return static_cast<Enum>(i); });
}

bool refuse(FieldReader& fields, std::string_view key, const std::string& what) {
    fields.error(key, what);
    return false;
}

void makeSet(std::vector<std::uint8_t>& classes) {
    std::sort(classes.begin(), classes.end());
    classes.erase(std::unique(classes.begin(), classes.end()), classes.end());
}

constexpr std::string_view columnPrefix = "column:";

Parsed<Color> parseOneColor(std::string_view text) {
    if (const auto flat = parse<Rgb8>(text)) return Color{ColorSource::Flat, *flat};
    return chooseEnum<ColorSource>(text, colorSourceNames, ", column:NAME or one colour as #rrggbb")
        .map([](ColorSource source) { return Color{source}; });
}

}  // namespace

Parsed<bool> parse(As<bool>, std::string_view text) {
    if (text == "true" || text == "false") return text == "true";
    return tl::unexpected("expected true or false, got " + quoteText(text));
}

Parsed<double> parse(As<double>, std::string_view text) {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code == std::errc::result_out_of_range && end == text.data() + text.size())
        return tl::unexpected(quoteText(text) + " is too large or too small for a number");
    if (code != std::errc{} || end != text.data() + text.size())
        return tl::unexpected(quoteText(text) + " is no number");
    return value;
}

Parsed<std::uint64_t> parseWhole(std::string_view text, std::uint64_t least, std::uint64_t most) {
    std::uint64_t value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc{} || end != text.data() + text.size() || value < least || value > most)
        return tl::unexpected(quoteText(text) + " is no whole number from " + std::to_string(least) +
                              (most == UINT64_MAX ? std::string(" upwards") : " to " + std::to_string(most)));
    return value;
}

tl::expected<void, std::string> parseNumbers(std::string_view text, std::span<double> out) {
    std::size_t count = 0;
    for (std::string_view rest = text;; ++count) {
        const auto comma = rest.find(',');
        if (count < out.size()) {
            const auto value = parse<double>(rest.substr(0, comma));
            if (!value) return passOn(value);
            out[count] = *value;
        }
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    if (count + 1 == out.size()) return {};
    return tl::unexpected("expected " + std::to_string(out.size()) +
                          " numbers with commas between them, got " + std::to_string(count + 1));
}

Parsed<glm::dvec3> parse(As<glm::dvec3>, std::string_view text) {
    return parse<std::array<double, 3>>(text).map([](const auto& v) { return glm::dvec3(v[0], v[1], v[2]); });
}

Parsed<ClipBox> parse(As<ClipBox>, std::string_view text) {
    return parse<std::array<double, 6>>(text).map([](const auto& v) {
        return ClipBox{glm::dvec3(v[0], v[1], v[2]), glm::dvec3(v[3], v[4], v[5])};
    });
}

Parsed<std::vector<std::uint8_t>> parse(As<std::vector<std::uint8_t>>, std::string_view text) {
    std::vector<std::uint8_t> result;
    if (text == "none") return result;
    for (std::string_view rest = text;;) {
        const auto comma = rest.find(',');
        const auto value = parseWhole(rest.substr(0, comma), 0, 255);
        if (!value) return passOn(value);
        result.push_back(static_cast<std::uint8_t>(*value));
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    makeSet(result);
    return result;
}

Parsed<ParameterValue> parse(As<ParameterValue>, std::string_view text) {
    if (const auto flag = parse<bool>(text)) return *flag;
    if (const auto number = parse<double>(text)) return *number;
    return std::string(text);
}

Parsed<Projection> parse(As<Projection>, std::string_view text) {
    return chooseEnum<Projection>(text, projectionNames);
}

Parsed<Shading> parse(As<Shading>, std::string_view text) {
    return chooseEnum<Shading>(text, shadingNames);
}

Parsed<Outliers> parse(As<Outliers>, std::string_view text) {
    return chooseEnum<Outliers>(text, outlierNames);
}

Parsed<Subsampling> parse(As<Subsampling>, std::string_view text) {
    if (text == "444") return Subsampling::S444;
    if (text == "422") return Subsampling::S422;
    if (text == "420") return Subsampling::S420;
    return chooseEnum<Subsampling>(text, subsamplingNames);
}

Parsed<std::string> parseColormap(std::string_view text) {
    return choose(text, colormapNames).map([](std::size_t i) { return std::string(colormapNames[i]); });
}

Parsed<Rgb8> parse(As<Rgb8>, std::string_view text) {
    const auto digits = text.starts_with('#') ? text.substr(1) : text;
    Rgb8 color{};
    bool sound = digits.size() == 6;
    for (std::size_t i = 0; sound && i < 3; ++i) {
        const int high = hexDigit(digits[2 * i]), low = hexDigit(digits[2 * i + 1]);
        sound = high >= 0 && low >= 0;
        color[i] = static_cast<std::uint8_t>(sound ? high * 16 + low : 0);
    }
    if (!sound) return tl::unexpected(quoteText(text) + " is no colour: write #rrggbb, such as #ff8800");
    return color;
}

Parsed<Color> parse(As<Color>, std::string_view text) {
    // The rest is the column's name, whatever stands in it.
    if (text.starts_with(columnPrefix))
        return Color{ColorSource::Column, {255, 255, 255}, false, std::string(text.substr(columnPrefix.size()))};
    const auto star = text.find('*');
    auto color = parseOneColor(text.substr(0, star));
    if (!color || star == std::string_view::npos) return color;
    if (text.substr(star + 1) != "intensity")
        return tl::unexpected("only intensity may stand behind the *, as in rgb*intensity, unlike " +
                              quoteText(text));
    if (!takesIntensity(color->source))
        return tl::unexpected(quoteText(text) +
                              " is no colour; rgb, elevation, classification, cloud and #rrggbb may be "
                              "multiplied by intensity");
    color->byIntensity = true;
    return color;
}

Parsed<Background> parse(As<Background>, std::string_view text) {
    Background result;
    if (text == "transparent") {
        result.kind = Background::Kind::Transparent;
        return result;
    }
    const auto comma = text.find(',');
    const auto top = parse<Rgb8>(text.substr(0, comma));
    const auto bottom = comma == std::string_view::npos ? top : parse<Rgb8>(text.substr(comma + 1));
    if (!top || !bottom)
        return tl::unexpected(
            quoteText(text) +
            " is no background: write transparent, #rrggbb, or two colours, #rrggbb,#rrggbb, "
            "for a gradient from top to bottom");
    result.kind = comma == std::string_view::npos ? Background::Kind::Color : Background::Kind::Gradient;
    result.top = *top;
    if (result.kind == Background::Kind::Gradient) result.bottom = *bottom;
    return result;
}

bool read(FieldReader& fields, std::string_view key, std::vector<std::uint8_t>& out) {
    const auto* array = fields.find(key);
    if (!array) return false;
    std::vector<std::uint8_t> result;
    if (!array->is_array() || array->size() > 256)
        return refuse(fields, key, "expected null or an array of at most 256 class numbers");
    for (const auto& item : *array) {
        if (!item.is_number_integer() || item < 0 || item > 255)
            return refuse(fields, key, "a class is a whole number from 0 to 255");
        result.push_back(item.get<std::uint8_t>());
    }
    makeSet(result);
    out = std::move(result);
    return true;
}

bool read(FieldReader& parent, std::string_view key, ClipBox& out) {
    const auto* object = parent.find(key);
    if (!object) return false;
    FieldReader fields(*object, parent.path(key));
    ClipBox box{};
    if (fields.require("min")) fields.vector("min", box.min);
    if (fields.require("max")) fields.vector("max", box.max);
    const auto result = fields.finishStrict();
    if (result)
        out = box;
    else
        parent.error(result.error());
    return result.has_value();
}

bool read(FieldReader& fields, std::string_view key, Background& out) {
    const auto* value = fields.find(key);
    if (!value) return false;
    if (value->is_null()) {
        out = {};
        return true;
    }
    std::string text;
    if (value->is_string())
        text = value->get<std::string>();
    else if (value->is_array() && value->size() == 2 && (*value)[0].is_string() && (*value)[1].is_string())
        text = (*value)[0].get<std::string>() + "," + (*value)[1].get<std::string>();
    else
        return refuse(fields, key, R"(expected "transparent", "#rrggbb" or ["#rrggbb", "#rrggbb"])");
    const auto parsed = parse<Background>(text);
    if (!parsed) return refuse(fields, key, parsed.error());
    out = *parsed;
    return true;
}

bool read(FieldReader& fields, std::string_view key, ParameterValues& out) {
    const auto* object = fields.find(key);
    if (!object) return false;
    if (!object->is_object()) return refuse(fields, key, R"(expected an object, such as {"sizePx": 5})");
    for (const auto& item : object->items()) {
        const auto& value = item.value();
        if (value.is_null())
            out.erase(item.key());
        else if (value.is_boolean())
            out[item.key()] = value.get<bool>();
        else if (value.is_number())
            out[item.key()] = value.get<double>();
        else if (value.is_string())
            out[item.key()] = value.get<std::string>();
        else
            return refuse(
                fields, key,
                "the value of " + quoteText(item.key()) + " must be a number, a string, true or false");
    }
    return true;
}

std::string print(Rgb8 color) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text = "#";
    for (const auto channel : color) {
        text += digits[channel >> 4u];
        text += digits[channel & 15u];
    }
    return text;
}

std::string print(const Color& color) {
    if (color.source == ColorSource::Column) return std::string(columnPrefix).append(color.column);
    const auto source =
        color.source == ColorSource::Flat ? print(color.flat) : std::string(name(color.source));
    return color.byIntensity ? source + "*intensity" : source;
}

json print(const Background& background) {
    if (background.kind == Background::Kind::Transparent) return "transparent";
    if (background.kind == Background::Kind::Color) return print(background.top);
    return json::array({print(background.top), print(background.bottom)});
}

json print(const ClipBox& box) {
    return {{"min", print(box.min)}, {"max", print(box.max)}};
}

json print(const ParameterValues& parameters) {
    json object = json::object();
    for (const auto& [key, value] : parameters)
        std::visit([&, &at = key](const auto& v) { object[at] = v; }, value);
    return object;
}

}  // namespace scancast::values
