#include "renderer/cloud/import/octree/point_layout.hpp"

#include <algorithm>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

constexpr std::size_t mostColumns = 512;  // of the point stream

struct Alias {
    std::string_view name, other;
};
constexpr Alias aliases[] = {
    {"scan_angle_rank", "scan_angle"}, {"scan_channel", "scanner_channel"},
    {"source_id", "point_source_id"},  {"infrared", "nir"},
    {"class_flag", "class_flags"},     {"classification_flags", "class_flags"},
};

bool isUpper(char c) {
    return c >= 'A' && c <= 'Z';
}
bool isLower(char c) {
    return c >= 'a' && c <= 'z';
}

bool isWhole(const Field& field) {
    if (field.scale != 1 || field.offset != 0) return false;
    if (field.role == Role::Intensity)
        return field.type == ColumnType::Uint8 || field.type == ColumnType::Uint16;
    return field.role != Role::Classification || field.type == ColumnType::Uint8;
}

}  // namespace

void PointLayout::add(Role role, ColumnType type, std::string_view name, double scale, double offset) {
    if (role < Role::Further && find(role)) role = Role::Further;
    fields_.push_back({role, type, bytes_, scale, offset, columnName(name)});
    bytes_ += static_cast<std::uint32_t>(bytesOf(type));
}

Expected<void> PointLayout::finish() {
    if (!find(Role::X) || !find(Role::Y) || !find(Role::Z))
        return fail(ErrorCode::Malformed, "its points have no position: three numbers x, y and z");
    const auto has = attributes();
    for (auto& field : fields_) {
        const bool color = field.role >= Role::Red && field.role <= Role::Blue;
        const bool normal = field.role >= Role::NormalX && field.role <= Role::NormalZ;
        if ((color && !has.color) || (normal && !has.normal)) field.role = Role::Further;
    }
    return {};
}

const Field* PointLayout::find(Role role) const {
    const auto found =
        std::find_if(fields_.begin(), fields_.end(), [&](const Field& field) { return field.role == role; });
    return found == fields_.end() ? nullptr : &*found;
}

Attributes PointLayout::attributes() const {
    const auto all = [&](std::initializer_list<Role> wanted) {
        return std::all_of(wanted.begin(), wanted.end(), [&](Role role) { return find(role) != nullptr; });
    };
    Attributes result;
    result.color = all({Role::Red, Role::Green, Role::Blue});
    result.intensity = all({Role::Intensity});
    result.classification = all({Role::Classification});
    result.normal = all({Role::NormalOctahedron}) || all({Role::NormalSphere}) ||
                    all({Role::NormalX, Role::NormalY, Role::NormalZ});
    return result;
}

bool PointLayout::hasWideColors() const {
    if (!attributes().color) return false;
    return std::any_of(fields_.begin(), fields_.end(), [](const Field& field) {
        return field.role >= Role::Red && field.role <= Role::Blue && field.type != ColumnType::Uint8;
    });
}

std::vector<const Field*> PointLayout::kept() const {
    std::vector<const Field*> result;
    for (const auto& field : fields_) {
        const bool further = field.role == Role::Further;
        const bool inPart =
            (field.role == Role::Intensity || field.role == Role::Classification) && !isWhole(field);
        if ((further || inPart) && result.size() < mostColumns) result.push_back(&field);
    }
    return result;
}

std::string columnName(std::string_view name) {
    std::string result;
    char before = '_';
    for (const char c : printableText(name, 64)) {
        // A new word begins with a capital letter behind a small one.
        if (isUpper(c) && isLower(before)) result += '_';
        result += isUpper(c) ? static_cast<char>(c - 'A' + 'a') : c == ' ' || c == '-' ? '_' : c;
        before = c;
    }
    for (const auto& alias : aliases)
        if (result == alias.name) return std::string(alias.other);
    return result.empty() ? "unnamed" : result;
}

std::vector<Column> columnsOf(const std::vector<const Field*>& fields) {
    std::vector<Column> columns;
    for (const auto* field : fields) {
        Column column{field->name, field->type, field->scale, field->offset, {}};
        const auto taken = [&] {
            return std::any_of(columns.begin(), columns.end(),
                               [&](const Column& c) { return c.name == column.name; });
        };
        for (int copy = 2; taken(); ++copy) column.name = field->name + "_" + std::to_string(copy);
        columns.push_back(std::move(column));
    }
    return columns;
}

}  // namespace scancast::import_octree
