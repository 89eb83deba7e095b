// Values of a view as text and as JSON, each by its type: parse, read, print.
//
// Not among the installed headers. Pure functions; any thread. Errors are sentences without a path: the
// caller knows it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "protocol/json_fields.hpp"
#include "protocol/view/view.hpp"

namespace scancast::values {

/// A value, or a sentence on what the text should say.
template <class T>
using Parsed = tl::expected<T, std::string>;

/// Where colours come from, or one colour for everything.
struct Color {
    ColorSource source = ColorSource::Rgb;
    Rgb8 flat{255, 255, 255};  ///< Flat only
};

template <class T>
Parsed<T> parse(std::string_view text);
template <>
Parsed<bool> parse(std::string_view text);
template <>
Parsed<double> parse(std::string_view text);
template <>
Parsed<std::array<double, 2>> parse(std::string_view text);
template <>
Parsed<std::array<double, 16>> parse(std::string_view text);
template <>
Parsed<glm::dvec3> parse(std::string_view text);
template <>
Parsed<ClipBox> parse(std::string_view text);
template <>
Parsed<Projection> parse(std::string_view text);
template <>
Parsed<Shading> parse(std::string_view text);
template <>
Parsed<Subsampling> parse(std::string_view text);
template <>
Parsed<Rgb8> parse(std::string_view text);  ///< "#rrggbb", or without the hash, which URLs make awkward
template <>
Parsed<Color> parse(std::string_view text);
template <>
Parsed<Background> parse(std::string_view text);  ///< "transparent", one colour, or "TOP,BOTTOM"
template <>
Parsed<std::vector<std::uint8_t>> parse(std::string_view text);  ///< classes: sorted, once each; or "none"
template <>
Parsed<ParameterValue> parse(std::string_view text);
Parsed<std::uint64_t> parseWhole(std::string_view text, std::uint64_t least, std::uint64_t most);
Parsed<std::string> parseColormap(std::string_view text);

/// What FieldReader does not read itself. Each leaves `out` alone when the field is missing or wrong, and
/// returns whether it was set.
bool read(FieldReader& fields, std::string_view key, ClipBox& out);
bool read(FieldReader& fields, std::string_view key, Background& out);  ///< null is the default
bool read(FieldReader& fields, std::string_view key, std::vector<std::uint8_t>& out);
bool read(FieldReader& fields, std::string_view key, ParameterValues& out);  ///< null removes a parameter
inline bool read(FieldReader& fields, std::string_view key, bool& out) {
    return fields.flag(key, out);
}
inline bool read(FieldReader& fields, std::string_view key, double& out) {
    return fields.number(key, out);
}
inline bool read(FieldReader& fields, std::string_view key, glm::dvec3& out) {
    return fields.vector(key, out);
}
template <std::size_t N>
bool read(FieldReader& fields, std::string_view key, std::array<double, N>& out) {
    return fields.numbers(key, out);
}
/// What JSON spells as words do.
template <class T, class Parse = Parsed<T> (*)(std::string_view)>
bool read(FieldReader& fields, std::string_view key, T& out, Parse parse = scancast::values::parse<T>) {
    std::string text;
    if (!fields.text(key, text)) return false;
    auto parsed = parse(text);
    if (!parsed) fields.error(key, parsed.error());
    if (parsed) out = std::move(*parsed);
    return parsed.has_value();
}
/// null clears.
template <class T>
bool read(FieldReader& fields, std::string_view key, std::optional<T>& out) {
    const auto* field = fields.find(key);
    if (field && field->is_null()) {
        out.reset();
        return true;
    }
    T value{};
    if (!read(fields, key, value)) return false;
    out = std::move(value);
    return true;
}

std::string print(Rgb8 color);
std::string print(const Color& color);
nlohmann::json print(const Background& background);
nlohmann::json print(const ClipBox& box);
nlohmann::json print(const ParameterValues& parameters);
inline nlohmann::json print(const glm::dvec3& vector) {
    return jsonArray(vector);
}
/// What JSON has itself, and what has a name.
template <class T>
nlohmann::json print(const T& value) {
    if constexpr (std::is_enum_v<T>)
        return name(value);
    else
        return value;
}
template <class T>
nlohmann::json print(const std::optional<T>& value) {
    return value ? nlohmann::json(print(*value)) : nlohmann::json();
}

}  // namespace scancast::values
