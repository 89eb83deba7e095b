#include "importers/octree/potree/potree_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "renderer/cloud/import/octree/json_values.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

using nlohmann::json;

constexpr std::size_t mostAttributes = 200;
constexpr std::uint64_t longestAttribute = 4096;
// Of a type that nobody tells: as many columns of a byte each.
constexpr std::uint32_t mostUntypedBytes = 16;

/// Names and bytes of Potree 1.
struct OldName {
    std::string_view name;
    std::uint32_t bytes;
    ColumnType type = ColumnType::Uint8;
};
constexpr OldName oldNames[] = {
    {"POSITION_CARTESIAN", 12},
    {"COLOR_PACKED", 4},
    {"RGBA_PACKED", 4},
    {"RGBA", 4},
    {"RGB_PACKED", 3},
    {"NORMAL_SPHEREMAPPED", 2},
    {"NORMAL_OCT16", 2},
    {"NORMAL", 12},
    {"NORMAL_FLOATS", 12},
    {"INTENSITY", 2, ColumnType::Uint16},
    {"CLASSIFICATION", 1},
    {"RETURN_NUMBER", 1},
    {"NUMBER_OF_RETURNS", 1},
    {"SOURCE_ID", 2, ColumnType::Uint16},
    {"INDICES", 4, ColumnType::Uint32},
    {"SPACING", 4, ColumnType::Float32},
    {"GPS_TIME", 8, ColumnType::Float64},
    {"FILLER_1B", 1},
};

enum class Shape : std::uint8_t {
    Position,
    Color8,
    Color16,
    Intensity,
    Classification,
    Sphere,
    Octahedron,
    Normal,
    NormalX,
    NormalY,
    NormalZ
};

/// What has room in a sample, by name (small letters, blanks for underscores) and bytes.
struct KnownShape {
    std::string_view name;
    std::uint32_t bytes;
    Shape shape;
};
constexpr KnownShape shapes[] = {
    {"position cartesian", 12, Shape::Position},
    {"position", 12, Shape::Position},
    {"color packed", 4, Shape::Color8},
    {"color packed", 3, Shape::Color8},
    {"rgba packed", 4, Shape::Color8},
    {"rgb packed", 3, Shape::Color8},
    {"rgba", 4, Shape::Color8},
    {"rgb", 3, Shape::Color8},
    {"rgb", 6, Shape::Color16},
    {"rgba", 8, Shape::Color16},
    {"intensity", 2, Shape::Intensity},
    {"classification", 1, Shape::Classification},
    {"normal spheremapped", 2, Shape::Sphere},
    {"normal oct16", 2, Shape::Octahedron},
    {"normal", 12, Shape::Normal},
    {"normal floats", 12, Shape::Normal},
    {"normalx", 4, Shape::NormalX},
    {"normaly", 4, Shape::NormalY},
    {"normalz", 4, Shape::NormalZ},
};

struct TypeName {
    std::string_view name;
    ColumnType type;
};
constexpr TypeName typeNames[] = {
    {"int8", ColumnType::Int8},      {"uint8", ColumnType::Uint8},     {"int16", ColumnType::Int16},
    {"uint16", ColumnType::Uint16},  {"int32", ColumnType::Int32},     {"uint32", ColumnType::Uint32},
    {"int64", ColumnType::Int64},    {"uint64", ColumnType::Uint64},   {"float", ColumnType::Float32},
    {"double", ColumnType::Float64}, {"float32", ColumnType::Float32}, {"float64", ColumnType::Float64},
};

/// An attribute as it is told.
struct Told {
    std::string name;
    std::uint32_t bytes = 0;
    std::optional<ColumnType> type;
    const json* scale = nullptr;
    const json* offset = nullptr;
};

Expected<Told> toldOf(const json& entry, std::size_t i) {
    Told told;
    if (entry.is_string()) {
        told.name = entry.get<std::string>();
        const auto known = std::find_if(std::begin(oldNames), std::end(oldNames),
                                        [&](const OldName& n) { return n.name == told.name; });
        if (known == std::end(oldNames))
            return fail(ErrorCode::Unsupported,
                        "the Potree attribute " + quotedText(told.name) + " is not known here");
        told.bytes = known->bytes;
        told.type = known->type;
        return told;
    }
    const auto& name = valueAt(entry, "name");
    if (!name.is_string()) return fail(ErrorCode::Malformed, fmt::format("attribute {} has no name", i));
    told.name = name.get<std::string>();
    const auto bytes = countOf(valueAt(entry, "size"), "the size of the attribute " + quotedText(told.name),
                               longestAttribute);
    if (!bytes) return passOn(bytes);
    told.bytes = static_cast<std::uint32_t>(*bytes);
    const auto type = wordOf(valueAt(entry, "type"));
    const auto known = std::find_if(std::begin(typeNames), std::end(typeNames),
                                    [&](const TypeName& t) { return t.name == type; });
    if (known != std::end(typeNames)) told.type = known->type;
    told.scale = &valueAt(entry, "scale");
    told.offset = &valueAt(entry, "offset");
    return told;
}

std::optional<Shape> shapeOf(const Told& told) {
    std::string key = told.name;
    for (char& c : key) c = c == '_' ? ' ' : c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    for (const auto& known : shapes)
        if (known.name == key && known.bytes == told.bytes) return known.shape;
    return std::nullopt;
}

double numberAt(const json* list, std::size_t i, double otherwise) {
    if (!list || !list->is_array() || i >= list->size() || !(*list)[i].is_number()) return otherwise;
    const auto value = (*list)[i].get<double>();
    return std::isfinite(value) && (otherwise == 0 || value != 0) ? value : otherwise;
}

void addFurther(const Told& told, PointLayout& layout) {
    if (told.name.starts_with("FILLER")) return layout.skip(told.bytes);
    const auto type = told.type.value_or(ColumnType::Uint8);
    const auto numbers = told.bytes / bytesOf(type);
    const bool fits = told.bytes % bytesOf(type) == 0 && (told.type || told.bytes <= mostUntypedBytes);
    if (!fits) return layout.skip(told.bytes);
    for (std::uint32_t i = 0; i < numbers; ++i)
        layout.add(Role::Further, type, numbers == 1 ? told.name : told.name + "_" + std::to_string(i),
                   numberAt(told.scale, i, 1), numberAt(told.offset, i, 0));
}

void addThree(PointLayout& layout, Role first, ColumnType type, std::array<std::string_view, 3> names) {
    for (int i = 0; i < 3; ++i)
        layout.add(static_cast<Role>(static_cast<int>(first) + i), type, names[static_cast<std::size_t>(i)]);
}

PotreeCode addShape(Shape shape, const Told& told, bool floats, PointLayout& layout) {
    const bool plainBytes = shape == Shape::Color8;
    switch (shape) {
        case Shape::Position:
            // Potree itself reads them as unsigned; what writes them does not, and points a step outside of their cube are
            // real.
            addThree(layout, Role::X, floats ? ColumnType::Float32 : ColumnType::Int32, {"x", "y", "z"});
            return floats ? PotreeCode::Plain : PotreeCode::Position;
        case Shape::Color8:
        case Shape::Color16: {
            const auto type = plainBytes ? ColumnType::Uint8 : ColumnType::Uint16;
            addThree(layout, Role::Red, type, {"red", "green", "blue"});
            layout.skip(told.bytes - 3 * static_cast<std::uint32_t>(bytesOf(type)));
            return plainBytes ? PotreeCode::Plain : PotreeCode::Color;
        }
        case Shape::Normal:
            addThree(layout, Role::NormalX, ColumnType::Float32, {"normal_x", "normal_y", "normal_z"});
            break;
        case Shape::Sphere:
            layout.add(Role::NormalSphere, ColumnType::Uint16, told.name);
            break;
        case Shape::Octahedron:
            layout.add(Role::NormalOctahedron, ColumnType::Uint16, told.name);
            break;
        case Shape::Intensity:
            layout.add(Role::Intensity, ColumnType::Uint16, told.name);
            break;
        case Shape::Classification:
            layout.add(Role::Classification, ColumnType::Uint8, told.name);
            break;
        case Shape::NormalX:
        case Shape::NormalY:
        case Shape::NormalZ:
            layout.add(static_cast<Role>(static_cast<int>(Role::NormalX) + static_cast<int>(shape) -
                                         static_cast<int>(Shape::NormalX)),
                       ColumnType::Float32, told.name);
            break;
    }
    return PotreeCode::Plain;
}

}  // namespace

Expected<PotreeLayout> layOutPotree(const json& list, bool floats) {
    if (!list.is_array() || list.empty() || list.size() > mostAttributes)
        return fail(ErrorCode::Malformed, "its list of point attributes is missing, empty or endless");
    PotreeLayout layout;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto told = toldOf(list[i], i);
        if (!told) return passOn(told);
        PotreeAttribute attribute{PotreeCode::Plain, layout.points.bytes(), told->bytes};
        const auto shape = shapeOf(*told);
        // The second of a kind is something else, whatever it is called.
        const bool again = shape == Shape::Position && layout.points.find(Role::X);
        if (shape && !again)
            attribute.code = addShape(*shape, *told, floats, layout.points);
        else
            addFurther(*told, layout.points);
        layout.attributes.push_back(attribute);
    }
    if (auto ok = layout.points.finish(); !ok) return passOn(ok);
    return layout;
}

}  // namespace scancast::import_octree
