// Values of a view as text and as JSON, each by its type: parse, read, print.
//
// Not among the installed headers. Pure functions; any thread. Errors are sentences without a path: the
// caller knows it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>

#include "protocol/json_fields.hpp"
#include "protocol/view/view.hpp"

namespace scancast::values {

/// A value, or a sentence on what the text should say.
template <class T>
using Parsed = tl::expected<T, std::string>;

/// Where colours come from, or one colour for everything; and whether intensity makes it brighter.
struct Color {
    ColorSource source = ColorSource::Auto;
    Rgb8 flat{255, 255, 255};  ///< Flat only
    bool byIntensity = false;
    std::string column{};  ///< Column only
};

template <class T>
using As = std::type_identity<T>;

Parsed<bool> parse(As<bool>, std::string_view text);
Parsed<double> parse(As<double>, std::string_view text);
Parsed<glm::dvec3> parse(As<glm::dvec3>, std::string_view text);
Parsed<ClipBox> parse(As<ClipBox>, std::string_view text);
Parsed<ClipShapes> parse(As<ClipShapes>, std::string_view text);  ///< with ; between them, or "auto"
Parsed<ColumnRanges> parse(As<ColumnRanges>, std::string_view text);  ///< with ; between them, or "auto"
Parsed<ViewedClouds> parse(As<ViewedClouds>, std::string_view text);  ///< with ; between them, or "auto"
Parsed<Projection> parse(As<Projection>, std::string_view text);
Parsed<Shading> parse(As<Shading>, std::string_view text);
Parsed<Outliers> parse(As<Outliers>, std::string_view text);
Parsed<Subsampling> parse(As<Subsampling>, std::string_view text);
Parsed<Rgb8> parse(As<Rgb8>,
                   std::string_view text);  ///< "#rrggbb"; without the hash, which URLs make awkward, too
Parsed<Color> parse(As<Color>, std::string_view text);
Parsed<Background> parse(As<Background>,
                         std::string_view text);  ///< "transparent", one colour, or "TOP,BOTTOM"
Parsed<std::vector<std::uint8_t>> parse(As<std::vector<std::uint8_t>>,
                                        std::string_view text);  ///< classes, or "auto"
Parsed<ParameterValue> parse(As<ParameterValue>, std::string_view text);
/// As many numbers as there is room for; what is there after an error means nothing.
tl::expected<void, std::string> parseNumbers(std::string_view text, std::span<double> out);
template <std::size_t N>
Parsed<std::array<double, N>> parse(As<std::array<double, N>>, std::string_view text) {
    std::array<double, N> numbers{};
    return parseNumbers(text, numbers).map([&] { return numbers; });
}
template <class T>
Parsed<T> parse(std::string_view text) {
    return parse(As<T>(), text);
}
Parsed<std::uint64_t> parseWhole(std::string_view text, std::uint64_t least, std::uint64_t most);
Parsed<std::string> parseColormap(std::string_view text);

/// What FieldReader does not read itself. Each leaves `out` alone when the field is missing or wrong, and
/// returns whether it was set.
bool read(FieldReader& fields, std::string_view key, ClipBox& out);
bool read(FieldReader& fields, std::string_view key, ClipShapes& out);  ///< null is none
bool read(FieldReader& fields, std::string_view key, ColumnRanges& out);  ///< null is none
bool read(FieldReader& fields, std::string_view key, ViewedClouds& out);  ///< null is none
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
template <class T>
bool read(FieldReader& fields, std::string_view key, T& out,
          Parsed<T> (*parse)(std::string_view) = scancast::values::parse<T>) {
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
nlohmann::json print(const ClipShapes& shapes);
nlohmann::json print(const ColumnRanges& ranges);
nlohmann::json print(const ViewedClouds& clouds);
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
