#include "renderer/cloud/export/las_layout.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/import/las/las_columns.hpp"
#include "renderer/cloud/import/las/las_header.hpp"

namespace scancast {

namespace {

constexpr std::uint32_t mostRecordBytes = 65535;
constexpr std::uint8_t mostOldClass = 31;

struct Wanted {
    LasField field;
    std::string_view name;
    ColumnType type;
    double scale = 1;
};
constexpr Wanted wanted[] = {
    {LasField::ReturnNumber, "return_number", ColumnType::Uint8},
    {LasField::NumberOfReturns, "number_of_returns", ColumnType::Uint8},
    {LasField::ScanDirection, "scan_direction_flag", ColumnType::Uint8},
    {LasField::EdgeOfFlightLine, "edge_of_flight_line", ColumnType::Uint8},
    {LasField::ClassFlags, "class_flags", ColumnType::Uint8},
    {LasField::ScannerChannel, "scanner_channel", ColumnType::Uint8},
    {LasField::OldScanAngle, "scan_angle", ColumnType::Int8},
    {LasField::NewScanAngle, "scan_angle", ColumnType::Int16, lasAngleStep},
    // Of scans with one and with the other, taken together.
    {LasField::OldScanAngle, "scan_angle_2", ColumnType::Int8},
    {LasField::NewScanAngle, "scan_angle_2", ColumnType::Int16, lasAngleStep},
    {LasField::UserData, "user_data", ColumnType::Uint8},
    {LasField::PointSource, "point_source_id", ColumnType::Uint16},
    {LasField::GpsTime, "gps_time", ColumnType::Float64},
    {LasField::Nir, "nir", ColumnType::Uint16},
    {LasField::Red, fullColorNames[0], ColumnType::Uint16},
    {LasField::Green, fullColorNames[1], ColumnType::Uint16},
    {LasField::Blue, fullColorNames[2], ColumnType::Uint16},
};

const Wanted* fieldOf(const Column& column) {
    const auto* found = std::ranges::find_if(wanted, [&](const Wanted& w) {
        return w.name == column.name && w.type == column.type && w.scale == column.scale &&
               column.offset == 0;
    });
    return found == std::end(wanted) ? nullptr : found;
}

/// Which field each column is, if any.
std::vector<const Wanted*> fieldsOf(std::span<const Column> columns) {
    std::vector<const Wanted*> fields;
    for (const Column& column : columns) fields.push_back(fieldOf(column));
    return fields;
}

bool has(std::span<const Wanted* const> fields, LasField field) {
    return std::ranges::any_of(fields, [&](const Wanted* w) { return w && w->field == field; });
}

/// Ten-thousandths of the size would do for most; as fine as 32 bits allow costs nothing.
void chooseGrid(const PointSurvey& ahead, LasLayout& layout) {
    const glm::dvec3 size = ahead.high - ahead.low;
    const double widest = std::max({size.x, size.y, size.z, 0.0});
    int digits = -9;
    while (widest / std::pow(10.0, digits) > 2e9) ++digits;
    // No finer than doubles of that size are.
    double farthest = 0;
    for (int a = 0; a < 3; ++a)
        farthest = std::max({farthest, std::abs(ahead.low[a]), std::abs(ahead.high[a])});
    while (std::pow(10.0, digits) < farthest * 1e-15) ++digits;
    const double step = digits < 0 ? 1 / std::pow(10.0, -digits) : std::pow(10.0, digits);
    for (int a = 0; a < 3; ++a) {
        const double middle = (ahead.low[a] + ahead.high[a]) / 2;
        layout.scale[a] = step;
        layout.offset[a] = std::isfinite(middle) ? std::floor(middle) + 0.0 : 0;
    }
}

bool isNewFamily(const ScanHeader& header, std::span<const Wanted* const> fields, const PointSurvey& ahead) {
    if (has(fields, LasField::ScannerChannel) || has(fields, LasField::NewScanAngle)) return true;
    // A scan that was of an old point format has no higher class, whatever nobody knows yet.
    const std::uint8_t otherwise = has(fields, LasField::OldScanAngle) ? 0 : 255;
    return header.attributes.classification && ahead.highestClass.value_or(otherwise) > mostOldClass;
}

}  // namespace

Expected<LasLayout> lasLayout(const ScanHeader& header, const PointSurvey& ahead) {
    LasLayout layout;
    const auto fields = fieldsOf(header.columns);
    const bool color = header.attributes.color, time = has(fields, LasField::GpsTime);
    const bool isNew = isNewFamily(header, fields, ahead);
    const bool nir = isNew && color && has(fields, LasField::ScannerChannel) && has(fields, LasField::Nir);
    if (isNew)
        layout.pointFormat = nir ? 8 : color ? 7 : 6;
    else
        layout.pointFormat = (time ? 1 : 0) + (color ? 2 : 0);
    const bool fullColor = findColumns(header.columns, fullColorNames, ColumnType::Uint16).has_value();

    const auto takes = [&](LasField field) {
        switch (field) {
            case LasField::ScannerChannel:
            case LasField::NewScanAngle:
                return isNew;
            case LasField::Nir:
                return nir;
            case LasField::Red:
            case LasField::Green:
            case LasField::Blue:
                return color && fullColor;
            default:
                return true;
        }
    };
    layout.fieldBytes = layout.recordBytes = lasRecordLayout(layout.pointFormat).bytes;
    std::size_t at = 0, bytes = layout.fieldBytes;
    for (std::size_t c = 0; c < header.columns.size(); ++c) {
        const Column& column = header.columns[c];
        if (fields[c] && takes(fields[c]->field) && !layout.field(fields[c]->field)) {
            layout.fields[std::size_t(fields[c]->field)] = at;
            if (fields[c]->field == LasField::GpsTime) {
                layout.adjustedTime = column.description == adjustedTimeText;
                layout.offsetTime = column.description.starts_with("offset GPS time");
            }
        } else {
            layout.extras.push_back({column, at});
            bytes += bytesOf(column.type);
        }
        at += bytesOf(column.type);
    }
    layout.normals = header.attributes.normal;
    if (layout.normals) bytes += 3 * sizeof(float);
    if (bytes > mostRecordBytes)
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format("LAS has room for 65,535 bytes a point, and the columns take {}; write PLY or CSV.",
                        bytes),
            "format");
    layout.recordBytes = std::uint32_t(bytes);
    layout.scale = header.gridStep;
    layout.offset = header.gridOrigin;
    if (!(header.gridStep.x > 0 && header.gridStep.y > 0 && header.gridStep.z > 0)) chooseGrid(ahead, layout);
    return layout;
}

}  // namespace scancast
