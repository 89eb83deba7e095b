#include "renderer/cloud/import/octree/json_values.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "protocol/json_text.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/wkt.hpp"

namespace scancast::import_octree {

namespace {

constexpr std::string_view byteOrderMark = "\xef\xbb\xbf";

std::string_view trimmed(std::string_view text) {
    const auto begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

std::optional<int> epsgOf(std::string_view text) {
    if (text.size() < 9 || text.size() > 11 || text[4] != ':') return std::nullopt;
    for (std::size_t i = 0; i < 4; ++i)
        if ((text[i] | 0x20) != "epsg"[i]) return std::nullopt;
    int code = 0;
    const auto [end, error] = std::from_chars(text.data() + 5, text.data() + text.size(), code);
    if (error != std::errc() || end != text.data() + text.size() || code <= 0) return std::nullopt;
    return code;
}

std::optional<glm::dvec3> soundVector(const nlohmann::json& value) {
    auto found = vectorOf(value, "");
    if (!found) return std::nullopt;
    return *found;
}

}  // namespace

Expected<nlohmann::json> parseJsonObject(std::span<const std::byte> bytes, const std::string& name) {
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with(byteOrderMark)) text.erase(0, byteOrderMark.size());
    for (char& c : text)
        if (static_cast<unsigned char>(c) > 0x7e) c = '?';
    auto value = parseJson(text);
    if (!value) return fail(ErrorCode::Malformed, name + " is not valid JSON: " + value.error().message);
    if (!value->is_object())
        return fail(ErrorCode::Malformed, name + " is not valid JSON: it is not an object");
    return value;
}

const nlohmann::json& valueAt(const nlohmann::json& object, const char* key) {
    static const nlohmann::json none;
    if (!object.is_object()) return none;
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

std::string shown(const nlohmann::json& value) {
    return value.is_null() ? "undefined" : printableText(printJson(value), 40);
}

std::string wordOf(const nlohmann::json& value) {
    if (value.is_string()) return value.get<std::string>();
    return value.is_number() ? printJson(value) : std::string();
}

Expected<double> numberOf(const nlohmann::json& value, const std::string& what) {
    if (value.is_number() && std::isfinite(value.get<double>())) return value.get<double>();
    return fail(ErrorCode::Malformed, fmt::format("{} is {}; it must be a number", what, shown(value)));
}

Expected<glm::dvec3> vectorOf(const nlohmann::json& value, const std::string& what) {
    if (!value.is_array() || value.size() != 3)
        return fail(ErrorCode::Malformed, what + " must be three numbers");
    glm::dvec3 vector{0};
    for (int i = 0; i < 3; ++i) {
        const auto number = numberOf(value[static_cast<std::size_t>(i)], fmt::format("{}[{}]", what, i));
        if (!number) return passOn(number);
        vector[i] = *number;
    }
    return vector;
}

Expected<std::uint64_t> countOf(const nlohmann::json& value, const std::string& what, std::uint64_t most) {
    if (value.is_number_unsigned() && value.get<std::uint64_t>() <= most) return value.get<std::uint64_t>();
    // Some programs write all numbers as floating point.
    if (value.is_number_float()) {
        const auto number = value.get<double>();
        if (number >= 0 && number == std::floor(number) && number <= 0x1p53 &&
            number <= static_cast<double>(most))
            return static_cast<std::uint64_t>(number);
    }
    return fail(ErrorCode::Malformed,
                fmt::format("{} is {}; it must be a whole number from 0 to {}", what, shown(value), most));
}

std::optional<std::array<glm::dvec3, 2>> boundsOf(const nlohmann::json& low, const nlohmann::json& high) {
    const auto least = soundVector(low);
    const auto greatest = soundVector(high);
    if (!least || !greatest) return std::nullopt;
    for (int i = 0; i < 3; ++i)
        if ((*least)[i] > (*greatest)[i]) return std::nullopt;
    return std::array{*least, *greatest};
}

void takeCrs(const std::string& text, ScanHeader& header) {
    if (const auto code = epsgOf(trimmed(text))) header.crsEpsg = code;
    const std::string wkt(trimmed(text));
    if (wkt.find('[') == std::string::npos || !parseWkt(wkt)) return;
    header.crsWkt = wkt;
    if (!header.crsEpsg) header.crsEpsg = epsgOfWkt(wkt);
}

Expected<void> checkGrid(const glm::dvec3& scale, const glm::dvec3& offset, const std::string& file) {
    for (int i = 0; i < 3; ++i)
        if (!(scale[i] > 0) || !std::isfinite(std::abs(offset[i]) + 0x1p32 * scale[i]))
            return fail(ErrorCode::Malformed,
                        file + ": the scale must be positive, and the points near enough to be numbers");
    return {};
}

}  // namespace scancast::import_octree
