#include "renderer/cloud/import/octree/ept_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

using nlohmann::json;

constexpr std::size_t mostDimensions = 400;
constexpr std::uint64_t mostEptPoints = std::uint64_t(1) << 53;

struct DataName {
    std::string_view name, extension;
    EptData data;
};
constexpr DataName dataNames[] = {{"laszip", "laz", EptData::Laszip},
                                  {"binary", "bin", EptData::Binary},
                                  {"zstandard", "zst", EptData::Zstandard}};

struct DimensionName {
    std::string_view name;  ///< in small letters
    Role role;
};
constexpr DimensionName dimensionNames[] = {
    {"x", Role::X},
    {"y", Role::Y},
    {"z", Role::Z},
    {"red", Role::Red},
    {"green", Role::Green},
    {"blue", Role::Blue},
    {"intensity", Role::Intensity},
    {"classification", Role::Classification},
    {"normalx", Role::NormalX},
    {"normaly", Role::NormalY},
    {"normalz", Role::NormalZ},
};

Role roleOf(std::string_view name) {
    std::string lower(name);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    const auto found = std::find_if(std::begin(dimensionNames), std::end(dimensionNames),
                                    [&](const DimensionName& d) { return d.name == lower; });
    return found == std::end(dimensionNames) ? Role::Further : found->role;
}

std::optional<ColumnType> typeOf(std::string_view kind, std::uint64_t size) {
    struct Known {
        std::string_view kind;
        std::uint64_t size;
        ColumnType type;
    };
    static constexpr Known known[] = {
        {"signed", 1, ColumnType::Int8},      {"signed", 2, ColumnType::Int16},
        {"signed", 4, ColumnType::Int32},     {"signed", 8, ColumnType::Int64},
        {"unsigned", 1, ColumnType::Uint8},   {"unsigned", 2, ColumnType::Uint16},
        {"unsigned", 4, ColumnType::Uint32},  {"unsigned", 8, ColumnType::Uint64},
        {"float", 4, ColumnType::Float32},    {"float", 8, ColumnType::Float64},
        {"floating", 4, ColumnType::Float32}, {"floating", 8, ColumnType::Float64},
    };
    for (const auto& [k, s, type] : known)
        if (k == kind && s == size) return type;
    return std::nullopt;
}

Expected<double> numberOr(const json& value, double otherwise, const std::string& what) {
    if (value.is_null()) return otherwise;
    return numberOf(value, what);
}

Expected<void> addDimension(const json& entry, std::size_t i, PointLayout& layout) {
    const auto name = wordOf(valueAt(entry, "name"));
    if (name.empty())
        return fail(ErrorCode::Malformed, fmt::format("ept.json: dimension {} of its schema has no name", i));
    const auto what = "ept.json: the dimension " + quotedText(name);
    const auto size = countOf(valueAt(entry, "size"), what + ": its size", 8);
    if (!size) return passOn(size);
    const auto kind = wordOf(valueAt(entry, "type"));
    const auto type = typeOf(kind, *size);
    if (!type)
        return fail(
            ErrorCode::Malformed,
            fmt::format(
                "{} is {} of {} bytes; signed and unsigned numbers of 1, 2, 4 or 8 bytes are read, and "
                "float of 4 or 8",
                what, quotedText(kind), *size));
    const auto scale = numberOr(valueAt(entry, "scale"), 1, what + ": its scale");
    if (!scale) return passOn(scale);
    if (!(*scale > 0))
        return fail(ErrorCode::Malformed,
                    fmt::format("{}: its scale is {}; it must be a positive number", what, *scale));
    const auto offset = numberOr(valueAt(entry, "offset"), 0, what + ": its offset");
    if (!offset) return passOn(offset);
    const Role role = roleOf(name);
    if (role < Role::Further && layout.find(role))
        return fail(ErrorCode::Malformed, what + " stands twice in its schema");
    layout.add(role, *type, name, *scale, *offset);
    return {};
}

Expected<void> readSchema(const json& schema, PointLayout& layout) {
    if (!schema.is_array() || schema.empty() || schema.size() > mostDimensions)
        return fail(ErrorCode::Malformed, "ept.json: its schema is missing, empty or endless");
    for (std::size_t i = 0; i < schema.size(); ++i)
        if (auto ok = addDimension(schema[i], i, layout); !ok) return ok;
    if (auto ok = layout.finish(); !ok) return fail(ErrorCode::Malformed, "ept.json: " + ok.error().message);
    return {};
}

/// [least x, y, z, greatest x, y, z]
std::optional<std::array<glm::dvec3, 2>> boundsOfSix(const json& six) {
    if (!six.is_array() || six.size() != 6) return std::nullopt;
    return boundsOf(json::array({six[0], six[1], six[2]}), json::array({six[3], six[4], six[5]}));
}

void takeSrs(const json& srs, ScanHeader& header) {
    takeCrs(wordOf(srs.is_string() ? srs : valueAt(srs, "wkt")), header);
    if (wordOf(valueAt(srs, "authority")) != "EPSG") return;
    const auto code = wordOf(valueAt(srs, "horizontal"));
    int number = 0;
    const auto [end, error] = std::from_chars(code.data(), code.data() + code.size(), number);
    if (error == std::errc() && end == code.data() + code.size() && number > 0) header.crsEpsg = number;
}

/// Where all three positions are whole numbers.
void takeGrid(const PointLayout& layout, ScanHeader& header) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto type = layout.find(static_cast<Role>(axis))->type;
        if (type == ColumnType::Float32 || type == ColumnType::Float64) return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const auto& field = *layout.find(static_cast<Role>(axis));
        header.gridStep[axis] = field.scale;
        header.gridOrigin[axis] = field.offset;
    }
}

}  // namespace

std::string_view name(EptData data) {
    return dataNames[static_cast<std::size_t>(data)].name;
}

std::string_view extension(EptData data) {
    return dataNames[static_cast<std::size_t>(data)].extension;
}

Expected<EptDescription> parseEptDescription(const json& json) {
    EptDescription ept;
    const auto version = wordOf(valueAt(json, "version"));
    // What was written before 1.0 says 0.0.0, and is the same.
    if (!version.starts_with("1.") && !version.starts_with("0."))
        return fail(ErrorCode::Unsupported,
                    fmt::format("ept.json has version {}; versions up to 1.1 are read", quotedText(version)));
    const auto data = wordOf(valueAt(json, "dataType"));
    const auto* known = std::find_if(std::begin(dataNames), std::end(dataNames),
                                     [&](const DataName& d) { return d.name == data; });
    if (known == std::end(dataNames))
        return fail(
            ErrorCode::Unsupported,
            fmt::format("ept.json has tiles of {}; laszip, binary and zstandard are read", quotedText(data)));
    ept.data = known->data;
    const auto& hierarchy = valueAt(json, "hierarchyType");
    if (!hierarchy.is_null() && wordOf(hierarchy) != "json")
        return fail(ErrorCode::Unsupported, fmt::format("ept.json has a hierarchy of {}; json is read",
                                                        quotedText(wordOf(hierarchy))));
    if (auto ok = readSchema(valueAt(json, "schema"), ept.layout); !ok) return passOn(ok);
    if (const auto& points = valueAt(json, "points"); !points.is_null()) {
        const auto count = countOf(points, "ept.json: the number of points", mostEptPoints);
        if (!count) return passOn(count);
        ept.points = *count;
    }
    ept.header.format = fmt::format("EPT {}, {}", printableText(version, 20), known->name);
    ept.header.attributes = ept.layout.attributes();
    ept.header.bounds = boundsOfSix(valueAt(json, "boundsConforming"));
    ept.cube = boundsOfSix(valueAt(json, "bounds"));
    if (!ept.header.bounds) ept.header.bounds = ept.cube;
    takeSrs(valueAt(json, "srs"), ept.header);
    takeGrid(ept.layout, ept.header);
    return ept;
}

}  // namespace scancast::import_octree
